// SPDX-License-Identifier: BSD-3-Clause
// What the first lesson and the answers to the lessons' questions claim, against values from elsewhere: Fermat's principle,
// mirror images, a cylinder's normals, hulls; and what the models do when a question is followed.
#include <algorithm>
#include <numbers>

#include "core/geometry/ellipsoid.h"
#include "core/geometry/epipolar.h"
#include "core/pipeline/summary.h"
#include "tests/sessions/taught.h"

namespace glint::lesson_answers {

using namespace taught;

double pathLength(const Eigen::Vector3d& eye, const Eigen::Vector3d& lamp, const Eigen::Vector3d& at) {
  return (eye - at).norm() + (lamp - at).norm();
}

/// Where light from the lamp reaches the eye: on the sheet z = (cos(k x') - 1) / k, bent about an axis along y, Fermat's
/// principle makes the way the shortest. A search that shrinks; it knows nothing of normals.
Eigen::Vector3d shortestWay(const Eigen::Vector3d& eye, const Eigen::Vector3d& lamp, double curvature) {
  const auto place = [&](double s, double y) {
    return curvature == 0 ? Eigen::Vector3d(s, y, 0)
                          : Eigen::Vector3d(std::sin(curvature * s) / curvature, y, (std::cos(curvature * s) - 1) / curvature);
  };
  double s = 0, y = 0;
  for (double step = 0.5; step > 1e-9; step *= 0.7)
    for (int i = 0; i < 12; ++i) {
      const double a = i * std::numbers::pi / 6, ds = step * std::cos(a), dy = step * std::sin(a);
      if (pathLength(eye, lamp, place(s + ds, y + dy)) < pathLength(eye, lamp, place(s, y))) s += ds, y += dy;
    }
  return place(s, y);
}

TEST(LessonAnswers, MovingHighlightLiesWhereTheWayIsShortestAndMovesByHalf) {
  const Inspection& in = lesson("moving-highlight").inspection;
  const Eigen::Vector3d lamp = in.scene->lights.at(0).lamp.position();
  std::vector<Eigen::Vector3d> at;
  std::vector<double> across, along;
  for (int frame = 0; frame < 10; ++frame) {
    const Explanation e = explain(in, frame, 0, "canonical");
    ASSERT_TRUE(e.view && e.view->seen);
    at.push_back(e.view->seen->brightest.point.position);
    const Eigen::Vector3d eye = e.view->camera.centreInWorld();
    EXPECT_LT((at.back() - shortestWay(eye, lamp, frame < 5 ? 0 : 1)).norm(), 1e-4) << "m, frame " << frame;
    EXPECT_NEAR(eye.z(), lamp.z(), 1e-12) << "equally high";
    Eigen::AlignedBox3d box;  // on the sheet: it is bent about an axis along y
    for (const Pixel& p : e.view->highlight.contour.points) {
      const Outcome<SurfacePoint> hit = e.view->surface->firstHit(e.view->camera.ray(p));
      ASSERT_TRUE(hit);
      box.extend(hit->position);
    }
    across.push_back(box.sizes().x());
    along.push_back(box.sizes().y());
    EXPECT_EQ(in.isHeldOut(frame), frame != 0 && frame != 2 && frame != 4) << "three frames trained";
  }
  for (int i = 0; i < 4; ++i) {
    const double flat = (at[std::size_t(i) + 1] - at[std::size_t(i)]).norm();
    const double bent = (at[std::size_t(i) + 6] - at[std::size_t(i) + 5]).norm();
    EXPECT_NEAR(flat, 0.125, 1e-4) << "half of 25 cm";
    EXPECT_LT(bent, 0.5 * flat);
    EXPECT_NEAR(bent, 0.055, 0.003) << "m";
  }
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_LT(across[i + 5], 0.5 * across[i]) << "less than half as wide";
    EXPECT_NEAR(along[i + 5] / along[i], 1, 0.05) << "as long as before";
  }
  for (const auto& [frame, error] : errorsByFrame(in, "canonical")) EXPECT_LT(error, 1.5) << "%, frame " << frame;
}

double areaOf(const std::vector<Pixel>& p) {
  double sum = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Pixel &a = p[i], &b = p[(i + 1) % p.size()];
    sum += 0.5 * (a.x() * b.y() - a.y() * b.x());
  }
  return std::abs(sum);
}

/// Root of the area on the table z = 0, m.
double onTable(const Highlight& highlight, const Camera& camera) {
  std::vector<Pixel> places;
  for (const Pixel& p : highlight.contour.points) {
    const Ray ray = camera.ray(p);
    places.push_back(ray.at(-ray.origin.z() / ray.direction.z()).head<2>());
  }
  return std::sqrt(areaOf(places));
}

TEST(LessonAnswers, MirrorEveryRayPointsAtTheMirroredLampWhichGrowsItWhenRaised) {
  const Inspection& in = lesson("mirror").inspection;
  const Eigen::Vector3d lamp = in.scene->lights.at(0).lamp.position(), mirrored(lamp.x(), lamp.y(), -lamp.z());
  EXPECT_LT((mirrored - Eigen::Vector3d(0.2, 0.4, -1.4)).norm(), 1e-12) << "as the text says";
  const auto synthesised = [](double rise) {
    return changed("mirror", [rise](InspectionRequest& r) {
      r.whatIf.synthesise = true;
      r.whatIf.roughness = 0.06;  // of its specification
      if (rise > 0) r.whatIf.lightsBy["lamp"] = {0, 0, rise};
    });
  };
  const Inspection low = synthesised(0), high = synthesised(1.4);
  for (std::size_t i = 0; i < 5; ++i) {
    const Camera& camera = in.scene->frames[i].camera;
    const Ray ray = camera.ray(in.evidence[i].highlights.at(0).peak);
    const Eigen::Vector3d to = mirrored - ray.origin;
    EXPECT_LT((to - to.dot(ray.direction) * ray.direction).norm(), 2e-4) << "m beside the mirrored lamp, frame " << i;
    // Closed form: the image of the lamp lies in a straight line. alpha = s (1/d + 1/r) / (2 cos) across the plane of incidence,
    // and the same with cos above along it; seen from d, under the slant.
    const auto size = [&](double rise) {
      const double straight = (Eigen::Vector3d(lamp.x(), lamp.y(), -lamp.z() - rise) - ray.origin).norm();
      const double d = straight * ray.origin.z() / (ray.origin.z() + lamp.z() + rise), r = straight - d;
      const double cosine = (ray.origin.z() + lamp.z() + rise) / straight;
      return std::sqrt(cosine) / (1 / d + 1 / r) / d;
    };
    // From the size in the photograph back to that on the table: farther away, and seen under the slant.
    const auto placed = [&](double rise) {
      const double straight = (Eigen::Vector3d(lamp.x(), lamp.y(), -lamp.z() - rise) - ray.origin).norm();
      const double cosine = (ray.origin.z() + lamp.z() + rise) / straight;
      return straight * ray.origin.z() / (ray.origin.z() + lamp.z() + rise) / std::sqrt(cosine);
    };
    const auto px = [&](const Inspection& of) { return std::sqrt(of.evidence[i].highlights.at(0).ellipse->semiAxes.prod()); };
    // A pixel off the optical axis sees a smaller solid angle, by the cosine cubed.
    const auto ofPixels = [&](const Inspection& of) {
      const Eigen::Vector3d axis = camera.camFromWorld.linear().row(2).transpose();
      return std::pow(camera.ray(of.evidence[i].highlights.at(0).peak).direction.dot(axis), -1.5);
    };
    EXPECT_NEAR(px(high) / px(low), 1.4, 0.05) << "as the text says";
    EXPECT_NEAR(onTable(high.evidence[i].highlights.at(0), camera) / onTable(low.evidence[i].highlights.at(0), camera), 1.26,
                0.02)
        << "as the text says";
    EXPECT_NEAR(onTable(high.evidence[i].highlights.at(0), camera) / onTable(low.evidence[i].highlights.at(0), camera),
                size(1.4) / size(0) * placed(1.4) / placed(0), 0.01);
    EXPECT_NEAR(px(high) / px(low) / (size(1.4) * ofPixels(high) / (size(0) * ofPixels(low))), 1, 0.02);
  }
}

struct Misses {
  double real, mirrored;
};
Misses missesOf(const Inspection& in, int i, int j) {
  const Explanation a = explain(in, i, 0, "primal"), b = explain(in, j, 0, "primal");
  const auto miss = [&](const Projection& p, const Projection& q) {
    const Outcome<EpipolarTangents> t = epipolarTangents(p, *a.view->highlight.ellipse, q, *b.view->highlight.ellipse);
    return t ? t->rmsPx() : std::nan("");
  };
  return {miss(a.view->camera.projection(), b.view->camera.projection()),
          miss(a.view->seen->virtualCamera, b.view->seen->virtualCamera)};
}

TEST(LessonAnswers, PlaneItsLinesTouchAndThreeFramesAreEnough) {
  const Inspection& in = lesson("plane").inspection;
  for (int i = 0; i < 6; ++i)
    for (int j = i + 1; j < 6; ++j) {
      const Misses m = missesOf(in, i, j);
      EXPECT_LT(m.real, 0.03) << i << j;
      EXPECT_LT(m.mirrored, 0.03) << i << j;
    }
  const auto trainedOn = [](const char* train) { return changed("plane", [&](InspectionRequest& r) { r.train = train; }); };
  const Inspection three = trainedOn("0,1,3"), two = trainedOn("0,3");
  for (const char* model : {"primal", "dual", "canonical", "limit-angle"})
    for (const auto& [frame, error] : errorsByFrame(three, model)) EXPECT_LT(error, 0.03) << model << ", frame " << frame;
  for (const char* model : {"primal", "dual", "canonical"}) {
    const Failure* const failure = two.models.at(model).fits.at(0).failure();
    ASSERT_TRUE(failure) << model;
    EXPECT_EQ(failure->reason, Reason::TooFewViews) << model;
  }
  EXPECT_EQ(errorsByFrame(two, "limit-angle").size(), 4u);
}

TEST(LessonAnswers, PlaneBentPrimalIsPoorAndLimitAngleFollows) {
  const Inspection bent = changed("plane", [](InspectionRequest& r) {
    r.whatIf.synthesise = true;
    r.whatIf.roughness = 0.07;  // the lobe that the panel starts from: that of the scene
    r.whatIf.surfaces["table"] = 0.5;
  });
  const ModelResult::Fit& primal = bent.models.at("primal").fits.at(0);
  EXPECT_STREQ(fitStatus(primal), "poor");
  EXPECT_NE(fitReason(primal).find("17.7 %"), std::string::npos) << fitReason(primal);
  EXPECT_EQ(errorsByFrame(bent, "primal").size(), 2u) << "it answers";
  EXPECT_EQ(errorsByFrame(bent, "limit-angle").size(), 2u);
  for (const auto& [frame, error] : errorsByFrame(bent, "limit-angle")) EXPECT_LT(error, 0.2) << "%, frame " << frame;
}

TEST(LessonAnswers, SphereEveryPairAndALargerSphere) {
  const Inspection& in = lesson("sphere").inspection;
  for (int i = 0; i < 6; ++i)
    for (int j = i + 1; j < 6; ++j) {
      const Misses m = missesOf(in, i, j);
      EXPECT_GT(m.real, 6 * m.mirrored) << i << j;
      EXPECT_TRUE(m.real > 0.4 && m.real < 5) << i << j << ": " << m.real;
      EXPECT_LT(m.mirrored, 0.3) << i << j;
    }
  EXPECT_NEAR(missesOf(in, 1, 3).real, 3.5, 0.05);
  EXPECT_NEAR(missesOf(in, 1, 3).mirrored, 0.2, 0.05);
  EXPECT_TRUE(in.isHeldOut(1)) << "what the lesson says of the frames between holds where it opens";
  const auto mean = [](const Inspection& of, const char* model) {
    double sum = 0;
    const std::map<int, double> all = errorsByFrame(of, model);
    for (const auto& [frame, error] : all) sum += error / double(all.size());
    return sum;
  };
  const auto withRadius = [](double radius) {
    return changed("sphere", [&](InspectionRequest& r) {
      r.whatIf.synthesise = true;
      r.whatIf.roughness = 0.12;  // of its specification
      r.whatIf.surfaces["body"] = radius;
    });
  };
  const Inspection small = withRadius(0.5), large = withRadius(0.7);
  EXPECT_NEAR(mean(large, "primal") / mean(small, "primal"), 4.0 / 3, 0.1) << "a third larger";
  EXPECT_LT(mean(large, "dual"), mean(small, "dual"));
  EXPECT_GT(mean(in, "canonical"), mean(in, "dual"));
  int seen = 0;
  for (const TrainingView& view : in.views) {
    if (!view.canonical || !view.canonical->ellipse) continue;
    ++seen;
    EXPECT_GT(view.canonical->ellipse->semiAxes.maxCoeff(), 4 * view.highlight.ellipse->semiAxes.maxCoeff());
  }
  EXPECT_EQ(seen, 3);
}

TEST(LessonAnswers, BentMirrorItsNumbersAndItsFocus) {
  const Inspection& in = lesson("bent-mirror").inspection;
  const Eigen::Vector3d lamp = in.scene->lights.at(0).lamp.position();
  const Explanation e = explain(in, 10, 0, "canonical");
  ASSERT_TRUE(e.view && e.view->seen);
  const Eigen::Vector3d eye = e.view->camera.centreInWorld(), at = e.view->seen->brightest.point.position;
  const double d = (eye - at).norm(), r = (lamp - at).norm(), cosine = (eye - at).normalized().z();
  EXPECT_NEAR(d, 1.47, 0.005);
  EXPECT_NEAR(r, 1.57, 0.005);
  EXPECT_NEAR(cosine, 0.955, 0.0005);
  EXPECT_NEAR(-(1 / d + 1 / r) / (2 * cosine), -0.69, 0.005);
  EXPECT_NEAR(3.34 * std::numbers::pi / 180, 0.0583, 5e-5);
  EXPECT_NEAR(0.0583 / (1 + (1 / 1.47 + 1 / 1.57) / (2 * 0.955)), 0.0345, 5e-5) << "the numbers in the text";
  // A hollow cylinder of that bend sends a ray across the bend back to the lamp: mirrored at its normal a little to the side.
  const double kappa = -(1 / d + 1 / r) / (2 * cosine), x = 0.02;
  const Eigen::Vector3d place(x, at.y(), -0.5 * kappa * x * x), normal = Eigen::Vector3d(kappa * x, 0, 1).normalized();
  const Eigen::Vector3d v = (eye - place).normalized(), to = lamp - place, out = 2 * normal.dot(v) * normal - v;
  EXPECT_LT((to - to.dot(out) * out).norm(), 0.02 * x) << "m beside the lamp";
  // A band: from edge to edge of the sheet across the bend, along the axis as high as on the flat sheet.
  const Inspection hollow = changed("bent-mirror", [&](InspectionRequest& q) {
    q.whatIf.synthesise = true;
    q.whatIf.roughness = 0.07;
    q.whatIf.surfaces[in.scene->frames[10].surface] = -0.69;
  });
  const auto extent = [](const Inspection& of) {
    const Highlight& h = of.evidence[10].highlights.at(0);
    Eigen::AlignedBox2d box;
    for (const Pixel& p : h.contour.points) box.extend(p);
    return Pixel(box.sizes());
  };
  const double edge = std::sin(0.69 * 0.6) / 0.69, rise = (1 - std::cos(0.69 * 0.6)) / 0.69;  // of the sheet of 1.2 m
  const Camera& camera = in.scene->frames[10].camera;
  const double wide = camera.project({edge, at.y(), rise})->x() - camera.project({-edge, at.y(), rise})->x();
  EXPECT_GT(extent(hollow).x(), wide - 1) << "px";
  EXPECT_NEAR(extent(hollow).y(), extent(in).y(), 0.3 * extent(in).y());
  // There the contour is the sheet's edge, whatever the lamp is.
  const ExplainStep limits = stepOf(explain(hollow, 10, 0, "limit-angle"), "limit-angles");
  ASSERT_EQ(limits.broken.size(), 1u);
  EXPECT_EQ(limits.broken[0].id, "contour-at-edge");
}

TEST(LessonAnswers, PlaneToCylinderWhoLeavesFirstAndWhatEachBendTeaches) {
  const Inspection& in = lesson("plane-to-cylinder").inspection;
  EXPECT_NEAR(errorsByFrame(in, "primal").at(4), 38, 0.5);
  EXPECT_NEAR(errorsByFrame(in, "dual").at(4), 18, 0.5);
  for (const char* model : {"canonical", "limit-angle"})
    for (const auto& [frame, error] : errorsByFrame(in, model)) EXPECT_LT(error, 0.5) << model << ", frame " << frame;
  const Inspection each = changed("plane-to-cylinder", [](InspectionRequest& r) { r.train = "per-surface"; });
  double worst = 0;
  for (const auto& [frame, error] : errorsByFrame(in, "dual")) worst = std::max(worst, error);
  EXPECT_NEAR(worst, 49.5, 0.5);
  int trained = 0;
  for (const FrameComparison& c : each.models.at("dual").frames)
    for (const FrameComparison::Row& row : c.rows)
      if (row.metrics) {
        ++trained;
        EXPECT_LT(row.metrics->contourErrorPct, 0.5) << "frame " << c.frame;
      }
  EXPECT_EQ(trained, 20);
}

/// Andrew's monotone chain.
std::vector<Pixel> hullOf(std::vector<Pixel> p) {
  std::sort(p.begin(), p.end(), [](const Pixel& a, const Pixel& b) { return std::pair(a.x(), a.y()) < std::pair(b.x(), b.y()); });
  std::vector<Pixel> hull;
  for (int side = 0; side < 2; ++side, std::reverse(p.begin(), p.end())) {
    const std::size_t from = hull.size();
    for (const Pixel& q : p) {
      while (hull.size() >= from + 2) {
        const Pixel a = hull[hull.size() - 1] - hull[hull.size() - 2], b = q - hull[hull.size() - 2];
        if (a.x() * b.y() - a.y() * b.x() > 0) break;
        hull.pop_back();
      }
      hull.push_back(q);
    }
    hull.pop_back();
  }
  return hull;
}

TEST(LessonAnswers, WaistTheHourglassAndTheStraightProfile) {
  const Inspection& in = lesson("waist").inspection;
  for (std::size_t frame = 0; frame < 10; ++frame)
    for (const Highlight& h : in.evidence[frame].highlights) {
      const double full = areaOf(h.contour.points) / areaOf(hullOf(h.contour.points));
      if (frame < 2 || frame > 5) {
        EXPECT_GT(full, 0.999) << "no dent in frame " << frame;
      } else if (frame > 2) {
        EXPECT_LT(full, 0.96) << "an hourglass in frame " << frame;
      } else {
        EXPECT_LT(full, 0.995) << "a dent in frame " << frame;
      }
    }
  // One curvature of either half falls towards 0 as they come together.
  for (const int half : {0, 1}) {
    double before = 0;
    for (int frame = 6; frame < 10; ++frame) {
      const Explanation e = explain(in, frame, half, "canonical");
      double least = 1e9;
      for (const ExplainNumber& n : stepOf(e, "tangent-plane").numbers)
        if (n.name == "principal curvature") least = std::min(least, std::abs(n.values[0]));
      EXPECT_GE(least, before * (1 - 1e-4)) << "frame " << frame << ", half " << half;
      before = least;
    }
    EXPECT_GT(before, 3) << "per metre, where they are far apart";
  }
  for (const auto& [frame, error] : errorsByFrame(in, "dual")) EXPECT_GT(error, 40) << "%, frame " << frame;
}

TEST(LessonAnswers, OnACylinderTheNormalTurnsMoreSlowlyAt45Degrees) {
  constexpr double kRadius = 0.5, s = 1e-3;
  const auto normal = [](double x) { return Eigen::Vector3d(x / kRadius, 0, std::sqrt(1 - x * x / (kRadius * kRadius))); };
  const auto turned = [&](double x) { return std::acos(normal(0).dot(normal(x))); };
  EXPECT_NEAR(turned(s * std::sqrt(0.5)) / turned(s), 0.7, 0.01);
  // And on the lesson's most bent sheet the walk on S ends between that along the axis and that across it.
  const Inspection& in = lesson("plane-to-cylinder").inspection;
  const Explanation e = explain(in, 18, 0, "canonical");
  ASSERT_TRUE(e.view && e.view->canonical);
  const Eigen::Vector3d at = e.view->seen->brightest.point.position;
  const Eigen::Vector3d axis(0, 1, 0), across90 = axis.cross(e.view->seen->tangentPlane.normal).normalized();
  std::map<int, double> ratio;  // of the ways on S and T, by degrees off the axis of the bend
  for (const DirectionResult& d : e.view->canonical->directions) {
    if (!d.limitAngle || d.failure) continue;
    const Eigen::Vector3d onT = d.onTangentPlane - at, onS = d.onSurface - at;
    const double off = std::atan2(std::abs(onT.dot(across90)), std::abs(onT.dot(axis))) * 180 / std::numbers::pi;
    for (const int wanted : {0, 45, 90})
      if (std::abs(off - wanted) < 4) ratio[wanted] = onS.norm() / onT.norm();
  }
  ASSERT_EQ(ratio.size(), 3u);
  EXPECT_NEAR(ratio[0], 1, 0.05);
  EXPECT_LT(ratio[45], 0.5);
  EXPECT_LT(ratio[90], ratio[45]);
}

}  // namespace glint::lesson_answers
