// SPDX-License-Identifier: BSD-3-Clause
// Contours by walks from the maxima against the level set, which is traced on its own: on analytic surfaces and meshes, where
// several highlights are seen, and where the region is no star.
#include "core/model/star_level_set.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/model/models.h"
#include "core/pipeline/metrics.h"
#include "core/reflectance/lobe_terms.h"
#include "core/surface/mesh.h"
#include "tests/core/model/exact_views.h"

namespace glint {
namespace {

using namespace test;

/// What the star may differ by, of the diameter: a hundredth of a percent.
constexpr double kStarPct = 0.01;

Settings starSettings() {
  Settings s;
  s.setFromText("predict.contour", "star");
  return s;
}
const Settings kStar = starSettings();

ModelFit radianceFit(const Light& light, Lobe lobe, double roughness, double radius = 0) {
  ModelFit fit;
  fit.lightEstimate = light;
  fit.family = ReflectanceFit{lobe, roughness, 0.5, SphereShape<>::of(radius)};
  return fit;
}

/// The stars themselves, without the level set behind them.
Outcome<std::vector<PredictedHighlight>> starsOf(const ModelFit& fit, const Camera& camera, const Surface& surface) {
  const auto mirrorPoints = brightestPointsFor(surface, camera, *fit.lightEstimate, kStar);
  if (!mirrorPoints) return mirrorPoints.failure();
  const ReflectanceFit& lobe = *fit.as<ReflectanceFit>();
  const RadianceField radiance(surface, camera, lobe.lobe, lobe.roughness, *fit.lamp());
  return radianceStars(radiance, lobe, *fit.lightEstimate, *mirrorPoints, 5.54, camera, surface, kStar);
}

void expectSameContours(const std::vector<PredictedHighlight>& whole, const std::vector<PredictedHighlight>& stars,
                        const std::string& what, double peakPx) {
  ASSERT_EQ(whole.size(), stars.size()) << what;
  for (std::size_t i = 0; i < whole.size(); ++i) {
    const PredictedHighlight &a = whole[i], &b = stars[i];
    EXPECT_LT(compareContours(a.contour, b.contour, b.gaps, b.ellipse, a.brightest.pixel, b.brightest.pixel).contourErrorPct,
              kStarPct)
        << what << " " << i;
    EXPECT_LT((a.brightest.pixel - b.brightest.pixel).norm(), peakPx) << what << " " << i;
    EXPECT_EQ(b.coverage, 1) << what;
  }
}

std::shared_ptr<const Surface> meshOf(const AnalyticSpec& spec, int cells) {
  return makeMesh(makeAnalytic(spec)->tessellate(Eigen::AlignedBox3d(), cells), NormalPolicy::Interpolated);
}

TEST(RadianceStars, AreTheLevelSetOnAnAnalyticSurface) {
  const Synthetic s = ellipsoidScene(7);
  const auto surface = makeAnalytic(s.surface);
  for (const Lobe lobe : {Lobe::TorranceSparrow, Lobe::Ggx, Lobe::BlinnPhong, Lobe::Phong})
    for (const double roughness : {0.02, 0.1, 0.2}) {
      const ModelFit fit = radianceFit(lightOf(s.light), lobe, roughness);
      for (const std::size_t i : {0, 3, 6}) {
        const auto stars = starsOf(fit, s.cameras[i], *surface);
        ASSERT_TRUE(stars) << nameOf(lobe) << " " << roughness << " " << i << ": " << stars.failure().message();
        expectSameContours(modelByName("reflectance").predict(fit, s.cameras[i], surface.get(), {}).highlights(), *stars,
                           nameOf(lobe), 1e-2);
      }
    }
}

TEST(RadianceStars, AreTheLevelSetOnAMesh) {
  const Synthetic s = ellipsoidScene(7);
  const auto surface = meshOf(s.surface, 300);
  for (const Lobe lobe : {Lobe::TorranceSparrow, Lobe::Ggx}) {
    const ModelFit fit = radianceFit(lightOf(s.light), lobe, 0.1);
    for (const std::size_t i : {0, 3, 6}) {
      const auto stars = starsOf(fit, s.cameras[i], *surface);
      ASSERT_TRUE(stars) << nameOf(lobe) << " " << i << ": " << stars.failure().message();
      // Kinks of the interpolated normals move a maximum by some thousandths of the region.
      expectSameContours(modelByName("reflectance").predict(fit, s.cameras[i], surface.get(), {}).highlights(), *stars,
                         nameOf(lobe), 0.05);
    }
  }
}

// The setting reaches the model: the same contours by predict.contour = star, and other vertices than the level set's.
TEST(RadianceStars, AreWhatTheSettingAsksFor) {
  const Synthetic s = ellipsoidScene(3);
  const auto surface = makeAnalytic(s.surface);
  const ModelFit fit = radianceFit(lightOf(s.light), Lobe::Ggx, 0.1);
  const Prediction whole = modelByName("reflectance").predict(fit, s.cameras[1], surface.get(), {}),
                   star = modelByName("reflectance").predict(fit, s.cameras[1], surface.get(), kStar);
  expectSameContours(whole.highlights(), star.highlights(), "setting", 1e-2);
  EXPECT_NE(whole.highlights().at(0).contour.points.size(), star.highlights().at(0).contour.points.size());
}

TEST(RadianceStars, Scale) {
  const Synthetic here = ellipsoidScene(3);
  for (const double scale : {1e-6, 1e-3, 1e3, 1e6}) {
    const Synthetic there = moved(here, pose(0.7, {1, -2, 0.5}), scale);
    const auto surface = makeAnalytic(there.surface);
    const ModelFit fit = radianceFit(lightOf(there.light), Lobe::TorranceSparrow, 0.1);
    const auto stars = starsOf(fit, there.cameras[1], *surface);
    ASSERT_TRUE(stars) << scale << " " << stars.failure().message();
    expectSameContours(modelByName("reflectance").predict(fit, there.cameras[1], surface.get(), {}).highlights(), *stars,
                       std::to_string(scale), 1e-2);
  }
}

// A light at infinity and one with a radius.
TEST(RadianceStars, OtherLights) {
  const Synthetic s = ellipsoidScene(3);
  for (const auto& surface : {makeAnalytic(s.surface), meshOf(s.surface, 200)})
    for (const ModelFit& fit : {radianceFit(Light::towards({1.2, -1.0, 2.2}), Lobe::Ggx, 0.1),
                                radianceFit(lightOf(s.light), Lobe::TorranceSparrow, 0.06, 0.2)}) {
      const auto stars = starsOf(fit, s.cameras[1], *surface);
      ASSERT_TRUE(stars) << surface->describe() << " " << stars.failure().message();
      expectSameContours(modelByName("reflectance").predict(fit, s.cameras[1], surface.get(), {}).highlights(), *stars,
                         surface->describe(), 0.05);
    }
}

/// A torus seen from above: one lamp gives it two unequal highlights and more.
struct Ring {
  AnalyticSpec spec = torus(0.5, 0.2);
  Camera camera = lookAt({0.3, -1.2, 2.0}, {0, 0, 0});
  Light light = Light::at({0.8, 0.9, 2.2});
};

TEST(RadianceStars, SeveralHighlightsOfOneLight) {
  const Ring ring;
  const auto surface = makeAnalytic(ring.spec);
  const ModelFit fit = radianceFit(ring.light, Lobe::TorranceSparrow, 0.05);
  const auto whole = modelByName("reflectance").predict(fit, ring.camera, surface.get(), {});
  ASSERT_GE(whole.highlights().size(), 2u);
  const auto stars = starsOf(fit, ring.camera, *surface);
  ASSERT_TRUE(stars) << stars.failure().message();
  expectSameContours(whole.highlights(), *stars, surface->describe(), 0.05);
}

TEST(RadianceStars, LimitAngleWithSeveralBrightestPoints) {
  const Ring ring;
  ModelFit fit;
  fit.lightEstimate = ring.light;
  fit.family = LimitAngleFit{0.04};
  for (const auto& surface : {makeAnalytic(ring.spec), meshOf(ring.spec, 400)}) {
    const Prediction whole = modelByName("limit-angle").predict(fit, ring.camera, surface.get(), {}),
                     stars = modelByName("limit-angle").predict(fit, ring.camera, surface.get(), kStar);
    ASSERT_GE(whole.highlights().size(), 2u);
    expectSameContours(whole.highlights(), stars.highlights(), surface->describe(), 1e-3);
    EXPECT_NE(whole.highlights()[0].contour.points.size(), stars.highlights()[0].contour.points.size())
        << "the stars were not used";
  }
}

// Where the region is no star the reason is named, and the model gives the level set itself.
TEST(RadianceStars, FallBackByName) {
  struct Row {
    const char* what;
    std::shared_ptr<const Surface> surface;
    Camera camera;
    Light light;
    double roughness;
    std::vector<Reason> reasons;  ///< any of them
  };
  const Ring ring;
  AnalyticSpec strip = sheet(0.5, 0.1, 2.0);
  std::vector<Row> rows{
      {"cut by the surface's edge",
       makeAnalytic(strip),
       lookAt({0.1, -0.3, 2}, {0, 0, 0}),
       Light::at({-0.2, 0.5, 2.2}),
       0.15,
       {Reason::SurfaceEnded}},
      {"cut by a mesh's edge",
       meshOf(strip, 100),
       lookAt({0.1, -0.3, 2}, {0, 0, 0}),
       Light::at({-0.2, 0.5, 2.2}),
       0.15,
       {Reason::SurfaceEnded}},
      {"a ring of one piece",
       makeAnalytic(ring.spec),
       lookAt({0.02, 0.01, 3}, {0, 0, 0}),
       Light::at({0, 0, 3.5}),
       0.15,
       {Reason::NotMonotonic, Reason::NotConverged, Reason::NotReached, Reason::NotSupported}},
      {"facets",
       makeMesh(makeAnalytic(ellipsoid(0.6, 0.35, 0.25))->tessellate(Eigen::AlignedBox3d(), 20), NormalPolicy::Facet),
       lookAt({0.1, -0.3, 2}, {0, 0, 0}),
       Light::at({-0.2, 0.5, 2.2}),
       0.15,
       {Reason::NotConverged, Reason::SurfaceEnded}}};
  for (const Row& row : rows) {
    const ModelFit fit = radianceFit(row.light, Lobe::TorranceSparrow, row.roughness);
    const auto stars = starsOf(fit, row.camera, *row.surface);
    ASSERT_FALSE(stars) << row.what;
    EXPECT_TRUE(std::count(row.reasons.begin(), row.reasons.end(), stars.failure().reason))
        << row.what << ": " << stars.failure().message();
    const HighlightModel& model = modelByName("reflectance");
    const Prediction whole = model.predict(fit, row.camera, row.surface.get(), {}),
                     star = model.predict(fit, row.camera, row.surface.get(), kStar);
    ASSERT_EQ(whole.highlights().size(), star.highlights().size()) << row.what;
    for (std::size_t i = 0; i < whole.highlights().size(); ++i)
      EXPECT_EQ(whole.highlights()[i].contour.points, star.highlights()[i].contour.points) << row.what;
  }
}

/// Two triangles' worth of a second body: its own highlight has no mirror point, only the place nearest to one at its edge.
TEST(RadianceStars, ARegionWithoutAMirrorPointIsNotOverlooked) {
  TriangleMesh both = makeAnalytic(sphere(0.3))->tessellate(Eigen::AlignedBox3d(), 100);
  // A flat patch beside the sphere whose plane mirrors the lamp half a degree outside of the patch.
  const Camera camera = lookAt({0.1, -0.3, 2.5}, {0, 0, 0});
  const Eigen::Vector3d lamp(-0.4, 0.5, 2.6), eye = camera.centreInWorld(), middle(0.45, 0, 0.1);
  const Eigen::Vector3d n = ((eye - middle).normalized() + (lamp - middle).normalized()).normalized();
  const Eigen::Vector3d u = n.cross(Eigen::Vector3d::UnitY()).normalized(), v = n.cross(u);
  const double size = 0.04;
  const int first = static_cast<int>(both.vertices.size());
  for (const auto& [a, b] : {std::pair{0.02, -1.0}, {1.0, -1.0}, {1.0, 1.0}, {0.02, 1.0}}) {
    both.vertices.push_back(middle + size * (a * u + b * v));
    both.normals.push_back(n);
  }
  both.triangles.emplace_back(first, first + 1, first + 2);
  both.triangles.emplace_back(first, first + 2, first + 3);
  const auto surface = makeMesh(both, NormalPolicy::Interpolated);
  const ModelFit fit = radianceFit(Light::at(lamp), Lobe::TorranceSparrow, 0.05);
  const Prediction whole = modelByName("reflectance").predict(fit, camera, surface.get(), {}),
                   star = modelByName("reflectance").predict(fit, camera, surface.get(), kStar);
  ASSERT_EQ(whole.highlights().size(), 2u);
  ASSERT_EQ(star.highlights().size(), 2u);
  const auto stars = starsOf(fit, camera, *surface);
  ASSERT_FALSE(stars);
  EXPECT_EQ(stars.failure().reason, Reason::NotSupported) << stars.failure().message();
}

// The bound holds: no point of a part has more radiance than its part may have. Parts here are single points with their exact
// angles.
TEST(RadianceBound, IsAboveTheRadiance) {
  for (const Lobe lobe : {Lobe::TorranceSparrow, Lobe::Ggx, Lobe::BlinnPhong, Lobe::Phong})
    for (const double m : {0.03, 0.2, 0.7, 0.95})
      for (int i = 0; i < 400; ++i) {
        // Directions above the horizon, on a spiral; the light at a distance of 2.
        const auto above = [](int k, int of, double turn) {
          const double z = (k + 0.5) / of, a = 2.399963 * k + turn, r = std::sqrt(1 - z * z);
          return Eigen::Vector3d(r * std::cos(a), r * std::sin(a), z);
        };
        const Eigen::Vector3d n = Eigen::Vector3d::UnitZ(), v = above(i % 20, 20, 0), l = above(i / 20, 20, 1);
        const std::optional<LogRadiance> exact = logRadiance(lobe, m, n, l, v);
        if (!exact) continue;
        const Eigen::Vector3d h = (l + v).normalized();
        PartBounds parts;
        parts.tanSquared.setConstant(float((1 - h.z() * h.z()) / (h.z() * h.z())));
        parts.cosView.setConstant(float(v.z()));
        parts.cosHalf.setConstant(float(h.dot(l)));
        parts.lightSquared.setConstant(4);
        EXPECT_GE(largestLogRadiance(lobe, m, parts)[3], exact->total() - std::log(4.0)) << nameOf(lobe) << " " << m << " " << i;
        // Smaller angles and a nearer horizon bound more.
        PartBounds wider = parts;
        wider.tanSquared *= 0.5f;
        wider.cosView *= 0.7f;
        EXPECT_GE(largestLogRadiance(lobe, m, wider)[0], exact->total() - std::log(4.0)) << nameOf(lobe) << " " << m << " " << i;
      }
}

// 1 / m^2 makes much of a float's round-off; the bound holds and stays near the radiance. At the mirror point and down to e^-25.
TEST(RadianceBound, OfANarrowLobe) {
  const double m = 0.01;
  constexpr double kClose = 0.02;  // of log I, whose own margin is 1e-4 of it
  for (const Lobe lobe : {Lobe::TorranceSparrow, Lobe::Ggx, Lobe::BlinnPhong, Lobe::Phong})
    for (int i = 0; i <= 200; ++i) {
      const double tilt = i * 5 * m / 200;
      const Eigen::Vector3d n = Eigen::Vector3d::UnitZ(), h(std::sin(tilt), 0, std::cos(tilt)),
                            v = Eigen::Vector3d(0.3, 0.2, 1).normalized(), l = 2 * h.dot(v) * h - v;
      const std::optional<LogRadiance> exact = logRadiance(lobe, m, n, l, v);
      ASSERT_TRUE(exact);
      PartBounds parts;
      parts.tanSquared.setConstant(float(std::tan(tilt) * std::tan(tilt)));
      parts.cosView.setConstant(float(v.z()));
      parts.cosHalf.setConstant(float(h.dot(l)));
      parts.lightSquared.setConstant(1);
      const double bound = largestLogRadiance(lobe, m, parts)[5];
      EXPECT_GE(bound, exact->total()) << nameOf(lobe) << " " << tilt;
      if (lobe == Lobe::BlinnPhong) {  // the others leave out shadows, or in which plane N is tilted
        EXPECT_LE(bound, exact->total() + kClose) << tilt;
      }
    }
}

}  // namespace
}  // namespace glint
