// SPDX-License-Identifier: BSD-3-Clause
#include "core/model/uncertainty.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/model/reconstruct.h"
#include "tests/core/model/coverage_trials.h"
#include "tests/tolerances.h"

namespace glint {
namespace {

using namespace test;

// Camera at height d straight above the plane, value = distance from the axis, level r: moving the level by s metres moves the
// circle by s f / d pixels everywhere.
TEST(LevelSetShifts, OfACircleSeenFromAbove) {
  const Camera camera = lookAt({0, 0, 4}, {0, 0, 0}, 800);
  const auto surface = makeAnalytic(plane());
  SurfaceField field;
  field.value = [](const SurfacePoint& p) { return std::optional<double>(p.position.head<2>().norm()); };
  field.level = 0.3;
  const double s = 0.002;
  const ColumnSlopes slopes = [&](const SurfacePoint& p) -> std::optional<Eigen::VectorXd> {
    // Level, and a shift of the centre along x: 3 s cos(azimuth).
    return Eigen::Vector2d(-s, -3 * s * p.position.x() / p.position.head<2>().norm());
  };
  std::vector<Pixel> circle;
  for (int i = 0; i < 24; ++i)
    circle.push_back(*camera.project({0.3 * std::cos(i * M_PI / 12), 0.3 * std::sin(i * M_PI / 12), 0}));
  const Eigen::VectorXd sigma = levelSetShiftsPx(circle, field, camera, *surface, slopes).rowwise().norm();
  ASSERT_EQ(sigma.size(), 24);
  for (int i = 0; i < 24; ++i)  // 1e-4: the difference over half a pixel of a radius of 60 px
    EXPECT_NEAR(sigma[i], s * 800 / 4 * std::hypot(1, 3 * std::cos(i * M_PI / 12)), 1e-4) << i;
  // Points that are not on the level lie on the surface's edge, or nowhere.
  const Eigen::MatrixXd none = levelSetShiftsPx({Pixel(10, 10), Pixel(1e9, 1e9)}, field, camera, *surface, slopes);
  EXPECT_EQ(none.rows(), 2);
  EXPECT_FALSE(none.any());
}

TEST(PolylineShifts, OfAGrowingCircle) {
  const auto circle = [](double radius, int n) {
    Polyline line{{}, true};
    for (int i = 0; i < n; ++i)
      line.points.emplace_back(50 + radius * std::cos(2 * M_PI * i / n), 40 + radius * std::sin(2 * M_PI * i / n));
    return line;
  };
  const double step = 0.25;
  for (const int other : {90, 400}) {  // the same vertices, and others
    const Eigen::MatrixXd shifts = polylineShiftsPx(circle(20, 90),
                                                    {{circle(20 + 3 * step, other), circle(20 - 3 * step, other)},
                                                     {circle(20 - 4 * step, other), circle(20 + 4 * step, other)}},
                                                    step);
    for (int i = 0; i < 90; ++i) EXPECT_NEAR(shifts.row(i).norm(), 5, 0.02) << other;  // chords of 90 vertices
  }
  EXPECT_EQ(polylineShiftsPx(circle(20, 12), {}, step).rows(), 12);
}

TEST(IncidentAngleByLight, AgreesWithDifferences) {
  std::mt19937_64 engine(7);
  std::normal_distribution<double> gauss;
  const auto random = [&] { return Eigen::Vector3d(gauss(engine), gauss(engine), gauss(engine)); };
  int behind = 0;
  for (int k = 0; k < 100; ++k) {
    const Eigen::Vector3d n = random().normalized(), v = random().normalized(), p = random();
    const Eigen::Vector4d light(gauss(engine), gauss(engine), gauss(engine), k % 3 == 0 ? 0.0 : std::abs(gauss(engine)));
    const auto alpha = [&](const Eigen::Vector4d& lw) {
      Eigen::Vector3d d = (lw.head<3>() - lw.w() * p).normalized();
      if (n.dot(d) < 0) d = -d;
      return incidentAngle(n, d, v);
    };
    behind += n.dot(light.head<3>() - light.w() * p) < 0;
    const Eigen::Vector4d gradient = incidentAngleByLight(p, n, v, light);
    const double h = 1e-5;
    for (int i = 0; i < 4; ++i) {
      const Eigen::Vector4d step = h * Eigen::Vector4d::Unit(i);
      const double slope = (alpha(light + step) - alpha(light - step)) / (2 * h);
      EXPECT_NEAR(gradient(i), slope, 1e-6 * (1 + std::abs(slope)) * 100) << k << " " << i;
    }
  }
  EXPECT_GT(behind, 20);
  EXPECT_LT(behind, 80);
}

/// Half width of the interval that the measured share of trials may leave: three standard errors of the mean over trials.
/// Directions of one trial move together, so their binomial spread alone would be too small; the trials themselves are
/// independent.
double slack(const CoverageResult& r) { return 3 * r.shareSpread / std::sqrt(double(r.trials - r.failed)); }

class Coverage : public testing::TestWithParam<int> {};

// docs/uncertainty.md has 1,000 trials of each; 80 here, so the slack is about 0.04.
TEST_P(Coverage, OfTheLimitAngleBandIsTheStatedOne) {
  CoverageTrials t;
  t.scene = coverageScenes()[GetParam()].second;
  t.trials = 80;
  for (const double coverage : {0.95, 0.6827}) {
    t.coverage = coverage;
    const CoverageResult r = runCoverageTrials(t);
    EXPECT_EQ(r.failed, 0);
    EXPECT_EQ(r.pairs, 80 * 36);
    EXPECT_NEAR(r.share(), coverage, slack(r)) << coverage;
    EXPECT_LT(slack(r), 0.15) << "the test could not fail";
    EXPECT_NEAR(r.meanNoisePx, t.noisePx, 0.1 * t.noisePx);
  }
}
TEST(CoverageOfRadiance, OfTheReflectanceBandIsTheStatedOne) {
  for (const int scene : {0, 3}) {
    CoverageTrials t;
    t.scene = coverageScenes()[scene].second;
    t.noisePx = 0.3;
    t.trials = 60;
    const CoverageResult r = runCoverageTrials(rightLobe(t));
    EXPECT_EQ(r.failed, 0);
    EXPECT_NEAR(r.share(), 0.95, slack(r)) << scene;
    EXPECT_NEAR(r.meanNoisePx, t.noisePx, 0.1 * t.noisePx);
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, Coverage, testing::Values(0, 2, 3, 5));

// Noise of 1 px on contours of 15 px radius: weights that err together with the residuals displaced the prediction by 0.042 px on
// average, half of its standard deviation, and the band missed the truth that much more often. The standard error of the mean is
// 0.009 px.
TEST(Bundle, NoiseLeavesNoBiasOfSecondOrder) {
  CoverageTrials t;
  t.scene = coverageScenes()[3].second;
  t.noisePx = 1;
  t.trials = 120;
  const CoverageResult r = runCoverageTrials(t);
  EXPECT_EQ(r.failed, 0);
  EXPECT_LT(r.biasPx, 0.025);
  EXPECT_NEAR(r.share(), 0.95, slack(r));
}

// Noise displaces the points of a curved contour outwards by sigma^2 / (2 R) on average: 0.04 px here, ten standard errors. The
// bundle removes it.
TEST(Bundle, SmallNoisyContoursDoNotWidenTheLimitAngle) {
  Synthetic s = sphereScene(6);
  s.limitAngle = 0.03;
  const FitInput exact = fitInput(s, {});
  const double pixels = std::sqrt(exact.views[0].highlight.areaPx2 > 0 ? exact.views[0].highlight.areaPx2 / M_PI : 12);
  double sum = 0;
  constexpr int kTrials = 60;
  for (int k = 0; k < kTrials; ++k) {
    std::vector<TrainingView> views;
    for (const TrainingView& v : exact.views) {
      FrameEvidence evidence;
      evidence.frame = v.frame;
      evidence.highlights = {withNoise(v.highlight, 1.0, 100 + k, v.frame, 0)};
      views.push_back(trainingView(evidence, 0, v.camera, v.surface));
    }
    const Outcome<LightEstimate> light = estimateLight(views, {});
    ASSERT_TRUE(light);
    sum += light->limitAngle;
  }
  const double biasPx = (sum / kTrials / s.limitAngle - 1) * pixels;
  RecordProperty("bias_px", std::to_string(biasPx));
  RecordProperty("radius_px", std::to_string(pixels));
  EXPECT_NEAR(biasPx, 0, 0.02);
}

FitInput noisyInput(const Synthetic& s, double noise, const Settings& settings = {}) {
  FitInput input = fitInput(s, settings);
  for (TrainingView& v : input.views) {
    FrameEvidence evidence;
    evidence.frame = v.frame;
    evidence.highlights = {withNoise(v.highlight, noise, 5, v.frame, 0)};
    v = trainingView(evidence, 0, v.camera, v.surface);
  }
  const Outcome<LightEstimate> light = estimateLight(input.views, settings);
  if (!light) throw std::runtime_error(light.failure().message());
  input.light = *light;
  for (TrainingView& v : input.views) addCanonicalContour(v, light->light, settings);
  return input;
}

TEST(Band, IsTheSameInPixelsAtEveryScale) {
  const Synthetic scene = sheetScene(0.4);
  for (const std::string name : {"limit-angle", "canonical", "dual"}) {
    const HighlightModel& model = modelByName(name);
    double reference = 0;
    for (const double scale : {1.0, 1e-4, 1e4}) {
      const Synthetic s = moved(scene, pose(0.3, {0.1, 0.2, 0.3}), scale);
      const Outcome<ModelFit> fit = model.fit(noisyInput(s, 0.3), {});
      ASSERT_TRUE(fit) << name << " " << fit.failure().message();
      const auto surface = makeAnalytic(s.surface);
      const Prediction p = model.predict(*fit, s.cameras[2], surface.get(), {});
      ASSERT_EQ(p.highlights().size(), 1u) << name;
      const std::vector<double> sigma = model.bandSigmaPx(*fit, p.highlights()[0], s.cameras[2], surface.get(), {});
      ASSERT_EQ(sigma.size(), p.highlights()[0].contour.points.size()) << name << " " << scale;
      double mean = 0;
      for (const double x : sigma) {
        ASSERT_TRUE(std::isfinite(x) && x > 0) << name;
        mean += x / double(sigma.size());
      }
      if (scale == 1) reference = mean;
      EXPECT_NEAR(mean / reference, 1, 1e-3) << name << " " << scale;
    }
  }
}

TEST(Band, IsEmptyWhereNothingIsKnown) {
  const Synthetic scene = sheetScene(0.4);
  const auto surface = makeAnalytic(scene.surface);
  Settings triangulated, anchored;
  triangulated.set("light.solver", std::string("triangulated"));
  anchored.set("fit.solver", std::string("anchored"));
  for (const auto& [name, settings] : {std::pair<std::string, Settings>("limit-angle", triangulated), {"canonical", anchored}}) {
    const HighlightModel& model = modelByName(name);
    const Outcome<ModelFit> fit = model.fit(noisyInput(scene, 0.3, settings), settings);
    ASSERT_TRUE(fit) << name;
    EXPECT_FALSE(fit->uncertainty) << name;
    const Prediction p = model.predict(*fit, scene.cameras[0], surface.get(), settings);
    ASSERT_FALSE(p.highlights().empty());
    EXPECT_TRUE(model.bandSigmaPx(*fit, p.highlights()[0], scene.cameras[0], surface.get(), settings).empty()) << name;
  }
}

// The covariance of the refined ellipsoid against the spread of 150 noisy fits: the ratio of two standard deviations from 150
// trials has a standard error of 6 %.
TEST(RefinedUncertainty, AgreesWithTheSpreadOfNoisyFits) {
  Eigen::Isometry3d place = pose(0.7, {0.2, -0.1, 0.3});
  const Ellipsoid truth(place, {0.5, 0.35, 0.2});
  std::vector<ConicView> exact;
  for (int i = 0; i < 5; ++i) {
    const Camera c = lookAt({3 * std::cos(1.1 * i), 3 * std::sin(1.1 * i), 1.0 + 0.4 * i}, {0.2, -0.1, 0.3});
    const Projection p = c.projection();
    const Outcome<Ellipse> e = outlineEllipse(truth, p);
    ASSERT_TRUE(e);
    exact.push_back({p, *e, e->sample(60)});
  }
  std::mt19937_64 engine(11);
  std::normal_distribution<double> gauss(0, 0.5);
  using Parameters = Eigen::Matrix<double, 9, 1>;
  std::vector<Parameters> found;
  Parameters expected = Parameters::Zero();
  constexpr int kTrials = 150;
  for (int k = 0; k < kTrials; ++k) {
    std::vector<ConicView> noisy = exact;
    for (ConicView& v : noisy)
      for (Pixel& q : v.points) q += Pixel(gauss(engine), gauss(engine));
    const Outcome<Reconstruction> r = reconstructRefined(noisy, truth);
    ASSERT_TRUE(r);
    ASSERT_TRUE(r->uncertainty);
    EXPECT_NEAR(r->uncertainty->noisePx, 0.5, 0.1);
    EXPECT_EQ(r->uncertainty->degreesOfFreedom, 5 * 60 - 9);
    Parameters p;
    const Eigen::Matrix3d s = r->ellipsoid->shape();
    p << r->ellipsoid->centre(), s(0, 0), s(1, 1), s(2, 2), s(0, 1), s(0, 2), s(1, 2);
    found.push_back(p);
    expected += r->uncertainty->root.rowwise().squaredNorm() / kTrials;
  }
  Parameters mean = Parameters::Zero(), spread = Parameters::Zero();
  for (const Parameters& p : found) mean += p / kTrials;
  for (const Parameters& p : found) spread += (p - mean).cwiseAbs2() / (kTrials - 1);
  for (int i = 0; i < 9; ++i) EXPECT_NEAR(std::sqrt(expected(i) / spread(i)), 1, 0.2) << i;
}

}  // namespace
}  // namespace glint
