// SPDX-License-Identifier: BSD-3-Clause
// Angles and numbers of views in closed form; the light's uncertainty follows the noise and not the unit of length.
#include "core/advise/conditioning.h"

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <numbers>
#include <numeric>

#include "tests/core/pipeline/exact_scene.h"
#include "tests/tolerances.h"

namespace glint {
namespace {
using namespace testing_support;
using Eigen::Vector3d;

constexpr double kDegPerRad = 180 / std::numbers::pi;

Vector3d inPlane(double degrees) { return {std::cos(degrees / kDegPerRad), std::sin(degrees / kDegPerRad), 0}; }

const Finding& finding(const Conditioning& c, const std::string& id) {
  const auto it = std::find_if(c.findings.begin(), c.findings.end(), [&](const Finding& f) { return f.id == id; });
  require(it != c.findings.end(), "no finding " + id);
  return *it;
}

/// A plane seen by eight cameras, everything `scale` times as large.
std::shared_ptr<Scene> planeScene(double scale) {
  auto scene = std::make_shared<Scene>();
  scene->surfaces["body"] = sheet(0);
  for (int i = 0; i < 8; ++i) {
    Frame f;
    f.id = std::to_string(i);
    const double a = 2.0 * std::numbers::pi * i / 8;
    f.camera = lookingAt(scale * Vector3d(0.5 * std::cos(a), 0.5 * std::sin(a) - 0.3, 1.5 + 0.2 * std::cos(3 * a)), {0, 0, 0});
    f.surface = "body";
    f.lightsOn = {"lamp"};
    f.highlights = exactContours(sheet(0), f.camera, {"lamp", scale * Vector3d(0.1, 0.2, 1.4)});
    scene->frames.push_back(std::move(f));
  }
  return scene;
}

std::vector<Conditioning> conditioned(std::shared_ptr<const Scene> scene, const std::string& train, double noisePx = 0) {
  InspectionRequest request;
  request.models = {"primal", "dual", "canonical", "limit-angle"};
  request.train = train;
  request.noisePx = noisePx;
  return conditioningOf(inspect(std::move(scene), request));
}

const Conditioning& of(const std::vector<Conditioning>& all, const std::string& model) {
  return *std::find_if(all.begin(), all.end(), [&](const Conditioning& c) { return c.model == model; });
}

TEST(WidestAngle, OfAFan) {
  EXPECT_NEAR(widestAngle({inPlane(10), inPlane(-20), inPlane(3)}) * kDegPerRad, 30, tolerance::kSolve);
  EXPECT_NEAR(widestAngle({inPlane(0), inPlane(180)}) * kDegPerRad, 180, tolerance::kSolve);
  EXPECT_EQ(widestAngle({inPlane(10)}), 0);
  EXPECT_EQ(widestAngle({}), 0);
}

TEST(WidestAngle, KeepsTheDigitsOfSmallAngles) {  // acos would give 0
  EXPECT_NEAR(widestAngle({Vector3d(1, 0, 0), Vector3d(1, 1e-9, 0)}), 1e-9, 1e-21);
}

TEST(EffectiveNumber, CountsRepeatedDirectionsOnce) {
  EXPECT_NEAR(effectiveNumber({inPlane(1), inPlane(1), inPlane(1), inPlane(1)}, 0.1), 1, tolerance::kSolve);
  EXPECT_NEAR(effectiveNumber({Vector3d::UnitX(), Vector3d::UnitY(), Vector3d::UnitZ()}, 0.1), 3, tolerance::kExact);
  // Two of them, half of the independent angle apart: 4 / (2 + 2 * 0.5).
  EXPECT_NEAR(effectiveNumber({inPlane(0), inPlane(5)}, 10 / kDegPerRad), 4.0 / 3, tolerance::kSolve);
  // Three groups of two.
  EXPECT_NEAR(effectiveNumber({inPlane(0), inPlane(0), inPlane(90), inPlane(90), inPlane(45), inPlane(45)}, 0.1), 3,
              tolerance::kSolve);
  EXPECT_EQ(effectiveNumber({}, 0.1), 0);
}

// On a plane the reflected ray runs from the mirrored camera centre to the light.
TEST(Conditioning, NominalOnAPlane) {
  const std::shared_ptr<Scene> scene = planeScene(1);
  const std::vector<Conditioning> all = conditioned(scene, "0-7");
  std::vector<Vector3d> rays;
  for (const Frame& f : scene->frames) {
    Vector3d mirrored = f.camera.centreInWorld();
    mirrored.z() = -mirrored.z();
    rays.push_back((Vector3d(0.1, 0.2, 1.4) - mirrored).normalized());
  }
  double widest = 0;
  for (const Vector3d& a : rays)
    for (const Vector3d& b : rays) widest = std::max(widest, std::acos(std::min(1.0, a.dot(b))));
  for (const char* model : {"dual", "canonical", "limit-angle"}) {
    const Conditioning& c = of(all, model);
    EXPECT_NEAR(finding(c, "angle").value, widest * kDegPerRad, 1e-5) << model;  // the peaks' accuracy
    EXPECT_EQ(finding(c, "angle").verdict, Verdict::Green) << model;
    EXPECT_EQ(finding(c, "views").verdict, Verdict::Green) << finding(c, "views").reason;
    EXPECT_EQ(finding(c, "light").verdict, Verdict::Green) << finding(c, "light").reason;
  }
  // Exact outlines of one quadric: ten singular values, the last one round-off beside the others.
  const Conditioning& dual = of(all, "dual");
  EXPECT_EQ(dual.singularValues.size(), 10u);
  EXPECT_LT(finding(dual, "gap").value, 0.05);
  EXPECT_EQ(dual.quadricKind, "ellipsoid");
  EXPECT_EQ(finding(dual, "signature").verdict, Verdict::Green);
  for (const Conditioning& c : all)
    for (const Finding& f : c.findings) {
      EXPECT_FALSE(f.reason.empty()) << f.id;
      EXPECT_EQ(f.reason.find(" deg"), std::string::npos) << f.reason;  // windows show it
      EXPECT_FALSE(f.text.empty()) << f.id;
    }
}

TEST(Conditioning, ScaleOfTheSceneDoesNotMatter) {
  const std::vector<Conditioning> metres = conditioned(planeScene(1), "0-7", 0.5),
                                  millimetres = conditioned(planeScene(1000), "0-7", 0.5);
  for (const char* model : {"primal", "dual", "canonical", "limit-angle"})
    for (const Finding& f : of(metres, model).findings) {
      const Finding& g = finding(of(millimetres, model), f.id);
      EXPECT_EQ(f.verdict, g.verdict) << model << " " << f.id << ": " << f.reason << " / " << g.reason;
      if (std::isfinite(f.value)) {
        EXPECT_NEAR(g.value, f.value, 1e-3 * std::abs(f.value)) << model << " " << f.id;
      }
    }
}

TEST(Conditioning, NoiseWidensTheLight) {  // first order: four times the noise, four times the standard deviation
  const double little = finding(of(conditioned(planeScene(1), "0-7", 0.25), "limit-angle"), "light").value;
  const double much = finding(of(conditioned(planeScene(1), "0-7", 1.0), "limit-angle"), "light").value;
  EXPECT_GT(much / little, 2.5);
  EXPECT_LT(much / little, 6);
}

// On a ball the canonical contour is several times as large as the highlight that it came from.
TEST(Conditioning, ResidualIsAShareOfTheContoursThatWereFitted) {
  InspectionRequest request;
  request.models = {"dual", "canonical"};
  request.train = "0-7";
  const Inspection inspection = inspect(exactScene(sphere(0.5), 8), request);
  const auto diameterOf = [](const std::vector<Pixel>& polygon) {  // of the circle with the same area
    double twice = 0;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Pixel &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
      twice += a.x() * b.y() - a.y() * b.x();
    }
    return 2 * std::sqrt(std::abs(twice) / 2 / std::numbers::pi);
  };
  double seen = 0, canonical = 0;
  int views = 0;
  for (const TrainingView& v : inspection.views) {
    ASSERT_TRUE(v.canonical);
    seen += diameterOf(v.highlight.contour.points);
    canonical += diameterOf(v.canonical->pixels);
    ++views;
  }
  ASSERT_EQ(views, 8);
  ASSERT_GT(canonical, 2 * seen);
  const std::vector<Conditioning> all = conditioningOf(inspection);
  for (const auto& [name, m] : inspection.models) {
    const std::vector<double>& r = m.fits.at(0).fit->residualPx;
    const double rms = std::sqrt(std::inner_product(r.begin(), r.end(), r.begin(), 0.0) / double(r.size()));
    const double diameter = (name == "canonical" ? canonical : seen) / views;
    const Finding& residual = finding(of(all, name), "residual");
    // The contours are ellipses to a few percent.
    EXPECT_NEAR(residual.value, rms / diameter, 0.05 * rms / diameter) << name << ": " << residual.reason;
  }
}

/// "2.4 px" here and "287 px" in the error table were both right, and of two different things that had one name.
TEST(Conditioning, AResidualIsNamedByWhatItMeasuresAndIsNoPraiseOfAnOutlineThatRunsFarBeyond) {
  using testing::HasSubstr;
  InspectionRequest request;
  request.models = {"dual", "canonical", "limit-angle"};
  request.train = "0-7";
  Inspection inspection = inspect(planeScene(1), request);
  const auto meaning = [&](const char* model) { return residualMeaning(*inspection.models.at(model).fits.at(0).fit); };
  EXPECT_THAT(meaning("dual"), HasSubstr("observed contour to the outline, one way"));
  EXPECT_THAT(meaning("canonical"), HasSubstr("canonical contour to the outline, one way"));
  EXPECT_THAT(meaning("limit-angle"), HasSubstr("level set"));
  const Finding before = finding(of(conditioningOf(inspection), "dual"), "residual");
  EXPECT_EQ(before.verdict, Verdict::Green);
  EXPECT_THAT(before.reason, HasSubstr("one way"));
  ContourMetrics& metrics = *inspection.models.at("dual").frames.at(3).rows.at(0).metrics;
  metrics.contourErrorPx = 287;
  metrics.contourErrorPct = 300;
  const Finding after = finding(of(conditioningOf(inspection), "dual"), "residual");
  EXPECT_EQ(after.verdict, Verdict::Red);
  EXPECT_EQ(after.text, before.text) << "the same number, seen for what it is";
  EXPECT_THAT(after.reason, HasSubstr("287 px"));
}

/// A peak dragged far off its highlight makes the rays wider apart, which is no better triangulation.
TEST(Conditioning, APeakOutsideItsContourIsNotPraised) {
  InspectionRequest request;
  request.models = {"primal", "dual", "limit-angle"};
  request.train = "0-7";
  const std::vector<Conditioning> before = conditioningOf(inspect(planeScene(1), request));
  request.whatIf.highlights[{3, 0}].peakBy = {160, 0};  // the contours are some 100 px wide
  const std::vector<Conditioning> after = conditioningOf(inspect(planeScene(1), request));
  for (const char* model : {"dual", "limit-angle"}) {
    EXPECT_EQ(finding(of(before, model), "angle").verdict, Verdict::Green);
    EXPECT_GT(finding(of(after, model), "angle").value, finding(of(before, model), "angle").value) << model;
    const Finding& peaks = finding(of(after, model), "peaks");
    EXPECT_EQ(peaks.verdict, Verdict::Red);
    EXPECT_EQ(peaks.value, 1);
    EXPECT_NE(peaks.reason.find("(frame 3)"), std::string::npos) << peaks.reason;
    for (const Finding& f : of(after, model).findings)
      EXPECT_NE(f.verdict, Verdict::Green) << model << " " << f.id << ": " << f.reason;
    const std::string reason = finding(of(after, model), "angle").reason;
    EXPECT_NE(reason.find("outside its contour"), std::string::npos) << reason;
  }
  for (const std::vector<Conditioning>* all : {&before, &after})  // primal looks at ellipses, not at peaks
    for (const Finding& f : of(*all, "primal").findings) EXPECT_NE(f.id, "peaks");
  // Within its contour, a peak may be moved.
  request.whatIf.highlights[{3, 0}].peakBy = {5, 0};
  for (const Conditioning& c : conditioningOf(inspect(planeScene(1), request)))
    for (const Finding& f : c.findings) EXPECT_NE(f.id, "peaks") << c.model;
}

TEST(Conditioning, DegenerateTwoViews) {
  const std::vector<Conditioning> all = conditioned(planeScene(1), "0,1");
  const Finding& f = finding(of(all, "dual"), "signature");
  EXPECT_EQ(f.text, "undetermined");
  EXPECT_EQ(f.verdict, Verdict::Red);
  EXPECT_THAT(f.reason, testing::HasSubstr("too few views"));
  EXPECT_EQ(finding(of(all, "dual"), "fit").verdict, Verdict::Red);
  EXPECT_EQ(of(all, "dual").worst(), Verdict::Red);
  EXPECT_LE(finding(of(all, "dual"), "views").value, 2.0);
}

TEST(Conditioning, DegenerateOneViewRepeated) {
  const std::shared_ptr<Scene> scene = planeScene(1);
  for (Frame& f : scene->frames) {
    f.camera = scene->frames[0].camera;
    f.highlights = scene->frames[0].highlights;
  }
  const Conditioning c = of(conditioned(scene, "0-7"), "dual");
  EXPECT_NEAR(finding(c, "views").value, 1, 1e-6);
  EXPECT_EQ(finding(c, "views").verdict, Verdict::Red);
  EXPECT_EQ(finding(c, "angle").verdict, Verdict::Red);
}

// a = sqrt(S_ii) of an ellipsoid along the axes of the world: a change of S_xx by t changes a by t / (2 a), one of S_xy to first
// order nothing.
TEST(SemiAxesSigma, AlongTheAxes) {
  ModelFit fit;
  EXPECT_FALSE(semiAxesSigma(fit));
  const Ellipsoid e = *Ellipsoid::fromCentreAndShape({1, 2, 3}, Vector3d(0.25, 0.09, 0.04).asDiagonal());
  fit.family = EllipsoidFit{e.dual(), e};
  EXPECT_FALSE(semiAxesSigma(fit));
  fit.uncertainty.emplace();
  fit.uncertainty->root = Eigen::MatrixXd::Zero(9, 3);
  fit.uncertainty->root(3, 0) = 0.02;   // S_xx
  fit.uncertainty->root(5, 1) = 0.008;  // S_zz
  fit.uncertainty->root(6, 2) = 0.5;    // S_xy
  const std::optional<Vector3d> sigma = semiAxesSigma(fit);
  ASSERT_TRUE(sigma);
  EXPECT_NEAR(sigma->x(), 0.02 / (2 * 0.5), tolerance::kExact);
  EXPECT_NEAR(sigma->y(), 0, tolerance::kExact);
  EXPECT_NEAR(sigma->z(), 0.008 / (2 * 0.2), tolerance::kExact);
}

TEST(Conditioning, AnEmptyInspectionHasNone) { EXPECT_TRUE(conditioningOf(Inspection{}).empty()); }

}  // namespace
}  // namespace glint
