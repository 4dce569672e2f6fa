// SPDX-License-Identifier: BSD-3-Clause
#include "core/advise/explain.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <sstream>

#include "core/advise/walk_trace.h"
#include "core/geometry/epipolar.h"
#include "tests/core/pipeline/exact_scene.h"

namespace glint {
namespace {

using namespace testing_support;

constexpr double kWalk = 1e-8;      // rad, of the walks' ends
constexpr double kPeak = 1e-6;      // m at 1.5 m: peaks of exact contours are found to 1e-7 px
constexpr double kChordDeg = 1e-3;  // the contours are chords 5e-3 px off the curve, where 100 px are 3.4 deg
constexpr double kCusp = 1e-6;      // rad: at the mirror point alpha is the distance from it, known to 1e-7 px
constexpr double kDegree = 57.29577951308232;

Inspection inspected(const AnalyticSpec& surface, const std::vector<std::string>& models) {
  InspectionRequest q;
  q.models = models;
  q.train = "first:4";
  return inspect(exactScene(surface, 6), q);
}

const ExplainStep& stepOf(const Explanation& e, const std::string& id) {
  for (const ExplainStep& s : e.steps)
    if (s.id == id) return s;
  throw std::runtime_error("no step " + id);
}

std::vector<double> number(const ExplainStep& s, const std::string& name) {
  for (const ExplainNumber& n : s.numbers)
    if (n.name == name) return n.values;
  ADD_FAILURE() << s.id << " has no number \"" << name << "\"";
  return {0, 0, 0};
}

bool breaks(const ExplainStep& s, const std::string& id) {
  return std::any_of(s.broken.begin(), s.broken.end(), [&](const BrokenAssumption& b) { return b.id == id; });
}

TEST(Explain, OnAPlaneEverythingHolds) {
  const Inspection inspection = inspected(sheet(0), {"primal", "canonical"});
  const Explanation e = explain(inspection, 1, 0, "primal");
  ASSERT_EQ(e.steps.size(), explainSteps().size());
  for (const ExplainStep& s : e.steps) EXPECT_FALSE(s.failure) << s.id << ": " << s.failure->message();
  // The ray to the mirrored lamp meets the plane z = 0 at the brightest point.
  const Eigen::Vector3d eye = inspection.scene->frames[1].camera.centreInWorld(), mirrored(0.1, 0.2, -1.4), d = mirrored - eye;
  const Eigen::Vector3d expected = eye - eye.z() / d.z() * d;
  const std::vector<double> at = number(stepOf(e, "peak"), "brightest point");
  EXPECT_LT((Eigen::Vector3d(at[0], at[1], at[2]) - expected).norm(), kPeak);
  EXPECT_NEAR(number(stepOf(e, "virtual-camera"), "of the mirror's 3x3 block")[0], -1, 1e-12);
  const std::vector<double> virtualCentre = number(stepOf(e, "virtual-camera"), "centre of the virtual camera");
  EXPECT_NEAR(virtualCentre[2], -eye.z(), 1e-9);
  EXPECT_NEAR(number(stepOf(e, "limit-angles"), "smallest limit angle")[0], kLimitAngle * kDegree, kChordDeg);
  EXPECT_NEAR(number(stepOf(e, "limit-angles"), "largest limit angle")[0], kLimitAngle * kDegree, kChordDeg);
  EXPECT_NEAR(number(stepOf(e, "canonical-ellipse"), "relative to the observed")[0], 1, 1e-3)
      << "a plane has nothing to take out";
  EXPECT_FALSE(breaks(stepOf(e, "virtual-camera"), "primal-off-plane"));
  EXPECT_TRUE(breaks(stepOf(e, "comparison"), "training-frame"));
}

TEST(Explain, OnASphereItSaysWhyPrimalFails) {
  const Inspection inspection = inspected(sphere(0.5), {"primal", "canonical"});
  const Explanation e = explain(inspection, 5, 0, "primal");
  EXPECT_NEAR(number(stepOf(e, "tangent-plane"), "principal curvature")[0], 2, 1e-9);
  EXPECT_TRUE(breaks(stepOf(e, "virtual-camera"), "primal-off-plane"));
  EXPECT_TRUE(breaks(stepOf(explain(inspection, 5, 0, "canonical"), "virtual-camera"), "primal-off-plane"))
      << "whichever model is explained";
  EXPECT_FALSE(
      breaks(stepOf(explain(inspected(sphere(0.5), {"canonical"}), 5, 0, "canonical"), "virtual-camera"), "primal-off-plane"))
      << "nobody asked for primal";
  EXPECT_FALSE(breaks(stepOf(e, "comparison"), "training-frame"));
  // A held-out frame has its own view and canonical contour; on a sphere they lie outside the observed one.
  ASSERT_TRUE(e.view && e.view->canonical);
  EXPECT_GT(number(stepOf(e, "canonical-ellipse"), "relative to the observed")[1], 1.2);
}

TEST(Explain, DualIsToldWhetherTheBendDiffersByPlaceOrByDirection) {
  const auto said = [](const AnalyticSpec& surface) {
    const ExplainStep step = stepOf(explain(inspected(surface, {"dual", "canonical"}), 5, 0, "canonical"), "virtual-camera");
    return std::array<bool, 2>{breaks(step, "dual-curvature-varies"), breaks(step, "dual-bends-one-way")};
  };
  EXPECT_EQ(said(cylinder(0.5)), (std::array<bool, 2>{false, true})) << "0 and 2 per metre at every place";
  EXPECT_EQ(said(sphere(0.5)), (std::array<bool, 2>{false, false})) << "the same curvature everywhere";
  // Radius 100 m: across a highlight of 0.1 m the normal turns by 1e-3 rad, a sixtieth of the limit angle.
  EXPECT_EQ(said(cylinder(100)), (std::array<bool, 2>{false, false}));
}

TEST(Explain, ChoosesTheRichestModelWithAnEllipsoid) {
  const Inspection inspection = inspected(sphere(0.5), {"primal", "canonical", "limit-angle"});
  EXPECT_EQ(explain(inspection, 0, 0, "").model, "canonical");
  EXPECT_EQ(explain(inspection, 0, 0, "reflectance").model, "canonical") << "it was not computed";
  const Explanation limit = explain(inspection, 0, 0, "limit-angle");
  EXPECT_EQ(limit.model, "limit-angle");
  EXPECT_TRUE(breaks(stepOf(limit, "ellipsoid"), "no-ellipsoid"));
}

/// Cameras in a row, `apart` metres from the first to the last, over the table z = 0.
std::shared_ptr<Scene> camerasInARow(double apart) {
  auto scene = exactScene(sheet(0), 6);
  for (int i = 0; i < 6; ++i) {
    Frame& f = scene->frames[std::size_t(i)];
    f.camera = lookingAt({0.5 + apart * i / 5, -0.3, 1.6}, {0, 0, 0});
    f.highlights = exactContours(sheet(0), f.camera, {"lamp", {0.1, 0.2, 1.4}});
  }
  return scene;
}

TEST(Explain, ReflectedRaysThatAreNearlyParallelAreSaid) {
  InspectionRequest q;
  q.models = {"canonical"};
  q.train = "first:6";
  for (const double apart : {0.05, 0.2}) {
    const Inspection inspection = inspect(camerasInARow(apart), q);
    const ExplainStep light = stepOf(explain(inspection, 0, 0, "canonical"), "light");
    // All rays go to the lamp: the widest angle is that between the mirrored cameras, seen from it.
    const Eigen::Vector3d lamp(0.1, 0.2, 1.4);
    const Eigen::Vector3d a = Eigen::Vector3d(0.5, -0.3, -1.6) - lamp, b = Eigen::Vector3d(0.5 + apart, -0.3, -1.6) - lamp;
    const double angle = std::atan2(a.cross(b).norm(), a.dot(b)) * kDegree;
    EXPECT_NEAR(number(light, "widest angle between them")[0], angle, 1e-4);
    EXPECT_EQ(number(light, "reflected rays")[0], 6);
    EXPECT_EQ(breaks(light, "rays-parallel"), angle < 2) << angle << " deg";
  }
}

/// On a plane alpha grows in proportion to the distance from the peak: a contour stretched by s in one direction has limit angles
/// from alpha to s alpha.
TEST(Explain, ALimitAngleThatVariesIsSaid) {
  for (const double stretch : {1.02, 1.12}) {
    auto scene = exactScene(sheet(0), 6);
    Highlight& h = scene->frames[5].highlights[0];
    for (Pixel& p : h.contour.points) p.x() = h.peak.x() + stretch * (p.x() - h.peak.x());
    InspectionRequest q;
    q.models = {"canonical"};
    q.train = "first:4";
    const Inspection inspection = inspect(scene, q);
    const ExplainStep step = stepOf(explain(inspection, 5, 0, "canonical"), "limit-angles");
    EXPECT_NEAR(number(step, "largest limit angle")[0] / number(step, "smallest limit angle")[0], stretch, 0.005);
    EXPECT_EQ(breaks(step, "limit-angle-varies"), stretch > 1.1);
    if (!breaks(step, "limit-angle-varies")) continue;
    EXPECT_NEAR(step.broken[0].numbers[0].values[0], 100 * (stretch - 1) / ((1 + stretch) / 2), 0.7) << "% of the mean";
  }
}

/// r (1 + e cos 3t) leaves its ellipse, the circle, by e r / sqrt 2 on average.
TEST(Explain, APeakOutsideItsContourIsSaidWithTheRayToIt) {
  for (const double byPx : {0.0, 20.0, 150.0}) {  // the contours are some 100 px wide
    InspectionRequest q;
    q.models = {"dual"};
    q.train = "first:4";
    q.whatIf.highlights[{1, 0}].peakBy = {byPx, 0};
    const ExplainStep step = stepOf(explain(inspect(exactScene(sheet(0), 6), q), 1, 0, "dual"), "peak");
    EXPECT_EQ(breaks(step, "peak-outside-contour"), byPx > 100) << byPx;
    for (const BrokenAssumption& b : step.broken) EXPECT_GT(b.numbers.at(0).values.at(0), 20);  // px from the contour
  }
}

TEST(Explain, AContourThatIsNoEllipseIsSaid) {
  for (const double ripple : {0.004, 0.03}) {
    auto scene = exactScene(sheet(0), 6);
    Highlight& h = scene->frames[5].highlights[0];
    h.ellipse.reset();
    h.contour.points.clear();
    for (int i = 0; i < 360; ++i) {
      const double a = i / kDegree, r = 90 * (1 + ripple * std::cos(3 * a));
      h.contour.points.push_back(h.peak + r * Pixel(std::cos(a), std::sin(a)));
    }
    InspectionRequest q;
    q.models = {"primal", "canonical"};
    q.train = "first:4";
    const Inspection inspection = inspect(scene, q);
    const double rms = 90 * ripple / std::sqrt(2.0);
    const bool said = ripple > 0.02;  // 2.1 % of the size; the other 0.3 %
    const ExplainStep primal = stepOf(explain(inspection, 5, 0, "primal"), "contour");
    EXPECT_NEAR(number(primal, "distance of the contour from its ellipse")[0], rms, 0.03 * rms);
    EXPECT_EQ(breaks(primal, "contour-not-elliptic"), said);
    EXPECT_FALSE(breaks(stepOf(explain(inspection, 5, 0, "canonical"), "contour"), "contour-not-elliptic"))
        << "it does not fit the contour itself";
    EXPECT_EQ(breaks(stepOf(explain(inspection, 5, 0, "canonical"), "canonical-ellipse"), "canonical-not-elliptic"), said);
  }
}

/// The last two singular values of a fit: exact contours of a plane leave one quadric, so their ratio is set here.
TEST(Explain, TwoQuadricsThatFitAlmostAlikeAreSaid) {
  Inspection inspection = inspected(sheet(0), {"canonical"});
  EllipsoidFit& fit = std::get<EllipsoidFit>(inspection.models.at("canonical").fits.at(0).fit->family);
  EXPECT_LT(fit.gapRatio, 0.01);
  for (const double ratio : {fit.gapRatio, 0.4, 0.6, 0.97}) {
    fit.gapRatio = ratio;
    const ExplainStep step = stepOf(explain(inspection, 5, 0, "canonical"), "ellipsoid");
    EXPECT_EQ(number(step, "last over second-last singular value")[0], ratio);
    EXPECT_EQ(breaks(step, "weak-gap"), ratio > 0.5) << ratio;
  }
}

const BrokenAssumption& broken(const ExplainStep& s, const std::string& id) {
  for (const BrokenAssumption& b : s.broken)
    if (b.id == id) return b;
  throw std::runtime_error(s.id + " does not say " + id);
}

/// A fit as it comes out where the views belong to no ellipsoid: a needle whose outline lies outside the image.
Inspection needle(const AnalyticSpec& surface, const std::string& model) {
  Inspection inspection = inspected(surface, {model});
  ModelResult& result = inspection.models.at(model);
  std::optional<Ellipsoid>& ellipsoid = std::get<EllipsoidFit>(result.fits.at(0).fit->family).ellipsoid;
  ellipsoid = Ellipsoid(ellipsoid->worldFromBody(), {0.02, 2.2, 0.015});
  for (FrameComparison& comparison : result.frames) {
    PredictedHighlight& p = comparison.prediction.editable()[0];
    p.brightest.pixel = Pixel(-500, 100);
    ContourMetrics metrics;
    metrics.contourErrorPx = 600 + comparison.frame;
    metrics.contourErrorPct = 2900;
    comparison.rows = {{0, 0, metrics, {}, {}}};
  }
  return inspection;
}

TEST(Explain, AFitThatHasFailedIsSaidInEveryStepThatUsesIt) {
  const std::vector<std::string> said{
      "needle", "training-missed", "prediction-outside", "prediction-misses", "primal-not-mirrored", "dual-keeps-bend"};
  for (const char* model : {"primal", "dual"}) {
    SCOPED_TRACE(model);
    const Inspection good = inspected(sheet(0), {model}), bad = needle(sphere(0.5), model);
    for (const ExplainStep& step : explain(good, 1, 0, model).steps)
      for (const std::string& id : said) EXPECT_FALSE(breaks(step, id)) << step.id << " " << id;
    const std::string why = model == std::string("primal") ? "primal-not-mirrored" : "dual-keeps-bend";
    const Explanation e = explain(bad, 1, 0, model);
    const ExplainStep &fit = stepOf(e, "ellipsoid"), &seen = stepOf(e, "projection"), &back = stepOf(e, "inverse-walk"),
                      &compared = stepOf(e, "comparison");
    EXPECT_EQ(broken(fit, "needle").numbers.at(0).values.at(0), 2.2);
    EXPECT_EQ(broken(fit, "needle").numbers.at(1).values.at(0), 0.02);
    EXPECT_EQ(broken(fit, "training-missed").numbers.at(0).values.at(0), 2900);
    EXPECT_NEAR(broken(seen, "prediction-outside").numbers.at(0).values.at(0), 500, 1e-9);
    for (const ExplainStep* step : {&seen, &back, &compared})
      EXPECT_EQ(broken(*step, "prediction-misses").numbers.at(0).values.at(0), 2900) << step->id;
    for (const ExplainStep* step : {&fit, &seen, &compared}) EXPECT_TRUE(breaks(*step, why)) << step->id;
    // Frames 0 to 3 train, and frame 3 is the worst of them: by the measure of the last step.
    EXPECT_EQ(number(fit, "largest mean distance in a training frame")[0], 603);
    EXPECT_EQ(number(stepOf(explain(bad, 3, 0, model), "comparison"), "mean distance of the contours")[0], 603);
  }
}

/// The left border of a fisheye's picture is seen 1.8 rad from the axis: to the left every ideal pixel is in the picture.
TEST(Explain, WhatAFisheyeSeesIsNotOutside) {
  Inspection inspection = needle(sphere(0.5), "dual");
  ASSERT_TRUE(breaks(stepOf(explain(inspection, 1, 0, "dual"), "projection"), "prediction-outside"));
  Scene scene = *inspection.scene;
  Camera& camera = scene.frames[1].camera;
  const double middle = (camera.width - 1) / 2.0, focal = middle / 1.8;
  camera.pixelFromRay << focal, 0, middle, 0, focal, (camera.height - 1) / 2.0, 0, 0, 1;
  camera.lens.model = LensModel::OpenCvFisheye;
  inspection.scene = std::make_shared<const Scene>(scene);
  EXPECT_FALSE(breaks(stepOf(explain(inspection, 1, 0, "dual"), "projection"), "prediction-outside"));
}

/// Before the walk back onto a bulging surface the highlight is that of a flat mirror: the ellipse on T, which the views' own
/// walks give as well. After it, it is the one that is seen.
TEST(Explain, TheProjectionOfCanonicalIsOnTAndTheWalkBackIsWhatIsSeen) {
  constexpr double kSameEllipse = 0.05;  // of an axis: how well one ellipsoid explains these views
  const Inspection inspection = inspected(sheet(1), {"canonical"});
  const Explanation e = explain(inspection, 1, 0, "canonical");
  const auto flat = number(stepOf(e, "projection"), "semi-axes of the ellipse that a flat mirror would show"),
             walked = number(stepOf(e, "inverse-walk"), "semi-axes of the resulting ellipse"),
             canonical = number(stepOf(e, "canonical-ellipse"), "semi-axes of the canonical ellipse"),
             observed = number(stepOf(e, "contour"), "semi-axes of its ellipse");
  for (std::size_t axis = 0; axis < 2; ++axis) {
    EXPECT_NEAR(flat[axis], canonical[axis], kSameEllipse * canonical[axis]);
    EXPECT_NEAR(walked[axis], observed[axis], kSameEllipse * observed[axis]);
  }
  EXPECT_GT(flat[1], 1.5 * walked[1]) << "the bend is in one of them only";
  EXPECT_EQ(number(stepOf(e, "inverse-walk"), "of directions gave a point")[0], 100);
}

TEST(Explain, TheComparisonSaysWhatABrokenAssumptionHasCost) {
  // The limit angle that the turn of the normal is held against comes with a model that knows the light.
  const Inspection ball = inspected(sphere(0.5), {"primal", "canonical"}), table = inspected(sheet(0), {"primal", "canonical"});
  const Explanation missed = explain(ball, 5, 0, "primal");
  ASSERT_GT(number(stepOf(missed, "comparison"), "of the equivalent diameter")[0], 2);
  EXPECT_TRUE(breaks(stepOf(missed, "comparison"), "primal-off-plane"));
  EXPECT_FALSE(breaks(stepOf(explain(ball, 5, 0, "canonical"), "comparison"), "primal-off-plane")) << "it is not its assumption";
  EXPECT_FALSE(breaks(stepOf(explain(table, 5, 0, "primal"), "comparison"), "primal-off-plane"));
}

/// An epipolar plane that touches an ellipsoid touches its outlines: on a table the ellipses are those of one ellipsoid for
/// either kind of camera, on a ball for neither.
TEST(Explain, TheEpipolarLinesSayHowFarTheViewsAreFromOneEllipsoid) {
  const auto misses = [](const AnalyticSpec& surface) {
    const Inspection bad = needle(surface, "primal");
    const BrokenAssumption why = broken(stepOf(explain(bad, 1, 0, "primal"), "ellipsoid"), "primal-not-mirrored");
    return std::array<double, 2>{why.numbers.at(0).values.at(0), why.numbers.at(1).values.at(0)};
  };
  const std::array<double, 2> table = misses(sheet(0)), ball = misses(sphere(0.5));
  for (const std::size_t kind : {0u, 1u}) {
    EXPECT_LT(table[kind], 0.02) << "px, of contours 100 px wide";
    EXPECT_GT(ball[kind], 0.2);
  }
  // Which is which: pair by pair, the virtual cameras from the reflection in each tangent plane.
  const Inspection seen = inspected(sphere(0.5), {"primal"});
  const auto camera = [](const TrainingView& v, bool mirrored) {
    Eigen::Matrix4d reflection = Eigen::Matrix4d::Identity();
    const Plane& plane = v.seen->tangentPlane;
    reflection.topLeftCorner<3, 3>() -= 2 * plane.normal * plane.normal.transpose();
    reflection.topRightCorner<3, 1>() = -2 * plane.offset * plane.normal;
    Projection p = v.camera.projection();
    if (mirrored) p.matrix *= reflection;
    return p;
  };
  for (const bool mirrored : {false, true}) {
    double sum = 0;
    int n = 0;
    for (std::size_t i = 0; i < seen.views.size(); ++i)
      for (std::size_t j = i + 1; j < seen.views.size(); ++j) {
        const TrainingView &a = seen.views[i], &b = seen.views[j];
        const Outcome<EpipolarTangents> t =
            epipolarTangents(camera(a, mirrored), *a.highlight.ellipse, camera(b, mirrored), *b.highlight.ellipse);
        if (!t) continue;
        sum += std::pow(t->rmsPx(), 2);
        ++n;
      }
    ASSERT_GT(n, 0);
    EXPECT_NEAR(ball[mirrored ? 1 : 0], std::sqrt(sum / n), 1e-9) << mirrored;
  }
  EXPECT_GT(std::abs(ball[0] - ball[1]), 0.01);
}

TEST(Explain, AMissedHighlightIsToldFromThePredictionThatLiesBesideIt) {
  Inspection inspection = inspected(sheet(0), {"canonical"});
  FrameComparison& comparison = inspection.models.at("canonical").frames.at(5);
  ASSERT_EQ(comparison.frame, 5);
  comparison.rows = {{0, -1, {}, Failure{Reason::NotReached, "no prediction overlaps this highlight"}, {}}, {-1, 0, {}, {}, {}}};
  const Explanation e = explain(inspection, 5, 0, "canonical");
  EXPECT_FALSE(stepOf(e, "projection").failure);
  EXPECT_TRUE(breaks(stepOf(e, "projection"), "prediction-misses"));
  EXPECT_TRUE(breaks(stepOf(e, "inverse-walk"), "prediction-misses"));
  EXPECT_TRUE(stepOf(e, "comparison").failure);
  // What is predicted for another highlight does not lie beside this one.
  comparison.rows.back() = {1, 0, {}, {}, {}};
  EXPECT_TRUE(stepOf(explain(inspection, 5, 0, "canonical"), "projection").failure);
  comparison.rows.pop_back();  // nothing is predicted at all: that is said instead
  comparison.prediction = Failure{Reason::NoBrightestPoint, ""};
  EXPECT_TRUE(stepOf(explain(inspection, 5, 0, "canonical"), "projection").failure);
}

TEST(Explain, SaysOfEachModelWhatItDoesInsteadOfAWalk) {
  const Inspection inspection = inspected(sheet(0), {"primal", "dual", "canonical", "limit-angle"});
  const auto said = [&](const char* model) {
    const Explanation e = explain(inspection, 5, 0, model);
    return std::array<bool, 2>{breaks(stepOf(e, "inverse-walk"), "outline-only"), breaks(stepOf(e, "inverse-walk"), "no-walk")};
  };
  // The outline of an ellipsoid has a centre and no brightest point.
  number(stepOf(explain(inspection, 5, 0, "primal"), "projection"), "centre of the predicted outline");
  number(stepOf(explain(inspection, 5, 0, "primal"), "comparison"), "its centre from the peak");
  number(stepOf(explain(inspection, 5, 0, "dual"), "projection"), "predicted brightest point");
  EXPECT_EQ(said("primal"), (std::array<bool, 2>{true, false}));
  EXPECT_EQ(said("dual"), (std::array<bool, 2>{true, false}));
  EXPECT_EQ(said("limit-angle"), (std::array<bool, 2>{false, true}));
  EXPECT_EQ(said("canonical"), (std::array<bool, 2>{false, false}));
}

/// Coordinates are good to about 1e-7: what is a thousandth of that and less is no number.
TEST(Explain, ACoordinateThatIsRoundOffIsZero) {
  Inspection inspection = inspected(sheet(0), {"canonical"});
  for (TrainingView& v : inspection.views) v.seen->tangentPlane.normal = {-1.2306e-10, 2e-7, 1};
  const std::vector<double> n = number(stepOf(explain(inspection, 1, 0, "canonical"), "tangent-plane"), "normal at P_B");
  EXPECT_EQ(n, (std::vector<double>{0, 2e-7, 1}));
  EXPECT_FALSE(std::signbit(n[0]));
}

/// Whatever the unit, a number says from where on it counts.
TEST(Explain, EveryMeasuredNumberSaysWhatIsRounding) {
  const Inspection inspection = inspected(sheet(0), {"primal", "canonical"});
  const Explanation e = explain(inspection, 1, 0, "primal");
  const std::set<std::string> measured{"m", "px", "deg", "%", "1/m"};
  const double distance = number(stepOf(e, "peak"), "distance from the camera")[0];
  int seen = 0;
  for (const ExplainStep& s : e.steps)
    for (const ExplainNumber& n : s.numbers) {
      EXPECT_EQ(n.least > 0, measured.count(n.unit) > 0) << s.id << ": " << n.name;
      if (n.unit == "m") {
        EXPECT_NEAR(n.least, 1e-6 * distance, 1e-12) << n.name;
      }
      // Contours are followed to 1e-3 px; seen at a focal length of 600 px, that is this angle. Errors are printed as 0.01 %.
      if (n.unit == "px") {
        EXPECT_EQ(n.least, 1e-3) << n.name;
      }
      if (n.unit == "deg") {
        EXPECT_NEAR(n.least, 1e-3 / 600 * 180 / std::numbers::pi, 1e-5) << n.name;
      }
      if (n.unit == "%") {
        EXPECT_LT(n.least, 0.5 * 0.01) << n.name;
      }
      seen += n.unit == "m";
    }
  EXPECT_GE(seen, 5);
  // The curvature of a plane.
  for (const ExplainNumber& n : stepOf(e, "tangent-plane").numbers)
    if (n.symbol == "κ₁") {
      EXPECT_LT(std::abs(n.values[0]), n.least);
    }
}

TEST(Explain, AFrameWithoutHighlightSaysSoInEveryStepThatNeedsOne) {
  auto scene = exactScene(sheet(0), 6);
  for (Highlight& h : scene->frames[5].highlights) h.level = 0.25;  // none at the level that is asked for
  InspectionRequest q;
  q.models = {"canonical"};
  q.train = "first:4";
  const Inspection inspection = inspect(scene, q);
  const Explanation e = explain(inspection, 5, 0, "canonical");
  EXPECT_EQ(e.highlight, -1);
  for (const char* id : {"peak", "tangent-plane", "virtual-camera", "contour", "limit-angles", "canonical-ellipse"}) {
    ASSERT_TRUE(stepOf(e, id).failure) << id;
    EXPECT_EQ(stepOf(e, id).failure->reason, Reason::NoHighlight) << id;
  }
  EXPECT_FALSE(stepOf(e, "light").failure);
  EXPECT_FALSE(stepOf(e, "ellipsoid").failure);
}

TEST(WalkTrace, OnAPlaneBothWalksAreOne) {
  const Inspection inspection = inspected(sheet(0), {"canonical"});
  const Explanation e = explain(inspection, 2, 0, "canonical");
  const TangentWalk walk(*e.view->surface, e.view->camera, e.view->seen->brightest, *e.lightUsed);
  const Outcome<WalkTrace> t = traceWalk(walk, *e.view->surface, e.view->canonical->directions[7], 25);
  ASSERT_TRUE(t);
  ASSERT_EQ(t->onSurface.size(), 25u);
  ASSERT_EQ(t->onPlane.size(), 25u);
  EXPECT_NEAR(t->reachOnPlane, t->reachOnSurface, kWalk);
  for (std::size_t i = 0; i < t->onSurface.size(); ++i) {
    const WalkPlace &s = t->onSurface[i], &p = t->onPlane[i];
    EXPECT_LT((s.position - s.onTangentPlane).norm(), 1e-12);
    EXPECT_LT((s.normal - p.normal).norm(), 1e-12);
    EXPECT_NEAR(s.alpha, p.alpha, kWalk);
  }
  EXPECT_NEAR(t->onSurface.back().alpha, t->limitAngle, 1e-6);
  EXPECT_NEAR(t->onPlane.back().alpha, t->limitAngle, 1e-6);
  EXPECT_NEAR(t->onSurface.front().alpha, e.view->seen->brightest.alpha, kCusp);
}

TEST(WalkTrace, OnASphereTheSurfaceFallsByItsSagittaAndTheNormalTurns) {
  const Inspection inspection = inspected(sphere(0.5), {"canonical"});
  const Explanation e = explain(inspection, 2, 0, "canonical");
  const TangentWalk walk(*e.view->surface, e.view->camera, e.view->seen->brightest, *e.lightUsed);
  const Outcome<WalkTrace> t = traceWalk(walk, *e.view->surface, e.view->canonical->directions[0], 25);
  ASSERT_TRUE(t);
  EXPECT_GT(t->reachOnPlane, t->reachOnSurface) << "the normal of a convex surface turns, so its limit is nearer";
  for (const WalkPlace& p : t->onSurface) {
    EXPECT_NEAR((p.position - p.onTangentPlane).norm(), 0.5 - std::sqrt(0.25 - p.distance * p.distance), 1e-9);
    // A sphere's normal leans by the distance over the radius.
    EXPECT_NEAR(p.normal.dot(walk.direction(t->azimuth)), p.distance / 0.5, 1e-9);
  }
  EXPECT_NEAR(t->onPlane.back().alpha, t->limitAngle, 1e-6);
  for (std::size_t i = 0; i < t->onPlane.size(); ++i) {  // the other walk stays on the plane, and its normal is the plane's
    const WalkPlace& p = t->onPlane[i];
    EXPECT_NEAR(walk.tangentPlane().signedDistance(p.position), 0, 1e-12);
    EXPECT_LT((p.normal - walk.tangentPlane().normal).norm(), 1e-12);
    EXPECT_NEAR(p.distance, t->reachOnPlane * double(i) / 24, 1e-12);
  }
}

TEST(WalkTrace, AFailedDirectionKeepsItsReason) {
  const Inspection inspection = inspected(sheet(0), {"canonical"});
  const Explanation e = explain(inspection, 2, 0, "canonical");
  const TangentWalk walk(*e.view->surface, e.view->camera, e.view->seen->brightest, *e.lightUsed);
  DirectionResult d = e.view->canonical->directions[0];
  d.failure = Failure{Reason::SurfaceEnded, "edge"};
  EXPECT_EQ(traceWalk(walk, *e.view->surface, d, 25).failure().reason, Reason::SurfaceEnded);
}

TEST(ExplainTexts, EveryStepAndEveryBrokenAssumptionHasItsSentence) {
  std::ifstream file(GLINT_SOURCE_DIR "/resources/explain/steps.json");
  const nlohmann::json texts = nlohmann::json::parse(file);
  std::vector<std::string> ids;
  for (const auto& step : texts["steps"]) {
    ids.push_back(step["id"]);
    for (const char* key : {"title", "text", "equation", "section"}) EXPECT_FALSE(step.at(key).get<std::string>().empty()) << key;
    EXPECT_FALSE(step.at("layers").empty());
  }
  EXPECT_EQ(ids, explainSteps());
  // Every id that the code can give, read from the code.
  std::stringstream code;
  for (const char* name : {"explain.cpp", "light_step.cpp", "mirror_step.cpp"})
    code << std::ifstream(std::string(GLINT_SOURCE_DIR "/core/advise/") + name).rdbuf();
  const std::string text = code.str();
  std::set<std::string> used;
  const std::regex given("broken\\.push_back\\(\\s*\\{\"([a-z-]+)\"");
  for (std::sregex_iterator it(text.begin(), text.end(), given), end; it != end; ++it) used.insert((*it)[1]);
  EXPECT_GT(used.size(), 8u);
  std::set<std::string> known;
  for (const auto& item : texts["broken"].items()) known.insert(item.key());
  EXPECT_EQ(used, known);
}

}  // namespace
}  // namespace glint
