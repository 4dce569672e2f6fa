// SPDX-License-Identifier: BSD-3-Clause
// Bands of predictions: the estimator of what whole views are off by against simulated residuals whose variances are known, and
// the whole pipeline against exact contours of scenes in which poses, scale and peaks are wrong.
#include <gtest/gtest.h>

#include <Eigen/QR>
#include <functional>
#include <random>

#include "core/base/uncertainty.h"
#include "core/model/view_effects.h"
#include "core/pipeline/inspection.h"
#include "core/report/texts.h"
#include "tests/core/pipeline/exact_scene.h"

namespace glint {
namespace {

using namespace testing_support;

constexpr int kPoints = 72;
constexpr double kNormal95 = 1.959964;

/// A round contour of a view at `place` along a baseline; four parameters: shifts, size, a shift that grows along the baseline.
struct Round {
  ContourShapes shapes;
  Eigen::MatrixXd byParameter{kPoints, 4};
  Eigen::VectorXd azimuth{kPoints};
  explicit Round(double place) {
    std::vector<Pixel> normals;
    std::vector<double> arc;
    for (int i = 0; i < kPoints; ++i) {
      const double a = 2 * std::numbers::pi * i / kPoints;
      azimuth(i) = a;
      normals.emplace_back(std::cos(a), std::sin(a));
      arc.push_back(double(i) / kPoints);
      byParameter.row(i) << std::cos(a), std::sin(a), 1 + 0.1 * place, place * std::cos(a) + 0.05 * place;
    }
    shapes = contourShapes(normals, arc);
  }
};

struct Simulated {
  std::vector<ViewResiduals> views;
  Eigen::VectorXd parameters;  ///< estimated; the true ones are zero
  Eigen::MatrixXd chart;       ///< parameters in units in which a fit has equal information on all, as Band hands them over
};

/// The shift of a view at a place along the baseline.
using ShiftAt = std::function<Pixel(double)>;

/// Bumps: a shift that swings slowly along the baseline, of this RMS.
ShiftAt bumps(double shift, unsigned seed) {
  std::mt19937_64 engine(seed);
  std::uniform_real_distribution<double> turn(0, 2 * std::numbers::pi), swings(0.2, 0.8);
  const double fx = swings(engine), fz = swings(engine), px = turn(engine), pz = turn(engine);
  return [=](double place) -> Pixel {
    return std::sqrt(2.0) * shift *
           Pixel(std::sin(2 * std::numbers::pi * fx * place + px), std::sin(2 * std::numbers::pi * fz * place + pz));
  };
}

/// Residuals of a least-squares fit to contours with noise of every point and a shift of every view.
Simulated simulated(int views, double noise, const ShiftAt& shiftAt, unsigned seed) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> gauss;
  std::vector<Round> rounds;
  Eigen::MatrixXd all(views * kPoints, 4);
  Eigen::VectorXd y(views * kPoints);
  for (int v = 0; v < views; ++v) {
    rounds.emplace_back(-0.5 + v / std::max(1.0, views - 1.0));
    const Pixel shift = shiftAt(-0.5 + v / std::max(1.0, views - 1.0));
    for (int i = 0; i < kPoints; ++i)
      y(v * kPoints + i) =
          noise * gauss(engine) + shift.x() * std::cos(rounds.back().azimuth(i)) + shift.y() * std::sin(rounds.back().azimuth(i));
    all.middleRows(v * kPoints, kPoints) = rounds.back().byParameter;
  }
  Simulated s;
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(all);
  s.parameters = qr.solve(y);
  const Eigen::MatrixXd upper = qr.matrixQR().topRows(4).triangularView<Eigen::Upper>();
  s.chart = upper.triangularView<Eigen::Upper>().solve(Eigen::MatrixXd::Identity(4, 4));
  const Eigen::VectorXd r = y - all * s.parameters;
  for (int v = 0; v < views; ++v)
    s.views.push_back({r.segment(v * kPoints, kPoints), rounds[std::size_t(v)].byParameter * s.chart,
                       rounds[std::size_t(v)].shapes, Eigen::VectorXd::Constant(1, -0.5 + v / std::max(1.0, views - 1.0))});
  return s;
}

/// The same with independent shifts.
Simulated simulated(int views, double noise, double shift, unsigned seed) {
  std::mt19937_64 engine(seed + 1000003);
  std::normal_distribution<double> gauss;
  const auto draw = [&](double) {
    const double x = gauss(engine), y = gauss(engine);  // as arguments their order would depend on the compiler
    return Pixel(shift * x, shift * y);
  };
  return simulated(views, noise, draw, seed);
}

constexpr double kBeyond = 0.9;  ///< place of a view outside the training views

/// Points of a view beyond the training views within the band, whose own error is this shift.
double inside(const Simulated& s, const Pixel& shift, bool placed) {
  const Round other(kBeyond);
  std::vector<ViewResiduals> views = s.views;
  if (!placed)
    for (ViewResiduals& v : views) v.where.resize(0);
  const std::vector<double> sigma =
      ViewEffects(views, 10).sigmaPx(other.byParameter * s.chart, other.shapes, Eigen::VectorXd::Constant(1, kBeyond));
  double in = 0;
  for (int i = 0; i < kPoints; ++i) {
    const double error = other.byParameter.row(i).dot(s.parameters) - shift.x() * std::cos(other.azimuth(i)) -
                         shift.y() * std::sin(other.azimuth(i));
    in += std::abs(error) <= kNormal95 * sigma[std::size_t(i)];
  }
  return in;
}

/// Share of the points of another view within the band, whose own error is a shift of this size.
double inside(int views, double noise, double shift, int trials) {
  double in = 0;
  std::mt19937_64 engine(12345);
  std::normal_distribution<double> gauss;
  for (int t = 0; t < trials; ++t) {
    const Pixel own = shift * Pixel(gauss(engine), gauss(engine));
    in += inside(simulated(views, noise, shift, unsigned(t + 1)), own, true);
  }
  return in / (double(trials) * kPoints);
}

/// The same where bumps shift neighbouring views alike.
double insideOnBumps(int views, double noise, double shift, int trials, bool placed) {
  double in = 0;
  for (int t = 0; t < trials; ++t) {
    const ShiftAt at = bumps(shift, unsigned(t + 1));
    in += inside(simulated(views, noise, at, unsigned(t + 1)), at(kBeyond), placed);
  }
  return in / (double(trials) * kPoints);
}

// With some of these seeds (1 and 5) round-off once made a shift that all views share, which no residual can show, the likeliest:
// nothing was left for single views.
TEST(ViewEffects, FindsTheSizesOfNoiseAndOfShifts) {
  for (unsigned seed = 1; seed <= 12; ++seed) {
    const ViewEffects e(simulated(60, 0.3, 0.5, seed).views, 10);
    EXPECT_NEAR(e.noisePx(), 0.3, 0.3 * 0.05) << seed;  // 3000 points tell it to 1.3 %: four of those
    EXPECT_NEAR(e.viewPx(), 0.5, 0.5 * 0.25)
        << seed;  // a shift has the mean square 0.5^2 over a round contour; 120 numbers tell it to 6.5 %
  }
}

TEST(ViewEffects, ScalesWithTheResiduals) {
  Simulated s = simulated(6, 0.3, 0.5, 2);
  const Round other(0.9);
  const ViewEffects before(s.views, 10);
  for (ViewResiduals& v : s.views) v.residual *= 7;
  const ViewEffects after(s.views, 70);
  EXPECT_NEAR(after.viewPx(), 7 * before.viewPx(), 1e-9);
  const Eigen::VectorXd there = Eigen::VectorXd::Constant(1, kBeyond);
  const auto a = before.sigmaPx(other.byParameter, other.shapes, there),
             b = after.sigmaPx(other.byParameter, other.shapes, there);
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(b[i], 7 * a[i], 1e-9 * b[i]);
}

TEST(ViewEffects, NoiseAloneIsNoErrorOfViews) {
  int none = 0;
  for (unsigned seed = 1; seed <= 40; ++seed) none += ViewEffects(simulated(6, 0.3, 0, seed).views, 10).viewPx() == 0;
  EXPECT_GE(none, 24);  // five tests at 5 % each leave 77 % of the runs without any; three standard errors below
  EXPECT_NEAR(inside(6, 0.3, 0, 100), 0.95, 0.035);
}

TEST(ViewEffects, BandsHoldAViewWhosePoseIsOff) {
  // With few views, pretests and the share that the parameters took keep it below 95 %.
  EXPECT_GT(inside(20, 0.1, 0.3, 100), 0.90);
  EXPECT_GT(inside(6, 0.1, 0.3, 100), 0.86);
  EXPECT_LT(inside(6, 0.1, 0.3, 100), 0.99);
}

// A prediction far from the training views: what their fit took of the bumps is not in their residuals.
TEST(ViewEffects, BandsHoldAViewFarAwayOnABumpySurface) {
  EXPECT_LT(insideOnBumps(8, 0.1, 0.3, 100, false), 0.80)
      << "as if bumps were independent: the case has to be one where that fails";
  EXPECT_GT(insideOnBumps(8, 0.1, 0.3, 100, true), 0.88);
  EXPECT_GT(insideOnBumps(20, 0.1, 0.3, 100, true), 0.88);
}

// --- how far errors go together
// ---------------------------------------------------------------------------------------------------

/// Views along a line, two shapes each, whose errors follow the recursion of an autoregressive process of order 1, no parameters
/// to take any.
std::vector<ViewCoefficients> line(int views, double sigma, double alike, double noise, unsigned seed) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> gauss;
  std::vector<ViewCoefficients> result;
  Pixel u = sigma * Pixel(gauss(engine), gauss(engine));
  for (int v = 0; v < views; ++v) {
    ViewCoefficients c;
    c.points = kPoints;
    c.group = {1, 1};
    c.value = std::sqrt(double(kPoints)) * u + noise * Pixel(gauss(engine), gauss(engine));
    c.byParameter = Eigen::MatrixXd::Zero(2, 1);
    c.where = Eigen::VectorXd::Constant(1, 0.1 * v);
    result.push_back(c);
    u = alike * u + std::sqrt(1 - alike * alike) * sigma * Pixel(gauss(engine), gauss(engine));
  }
  return result;
}

double weightOfIndependence(const std::vector<CorrelatedEffects>& effects) {
  return effects.front().length == 0 ? effects.front().weight : 0;
}
double meanVariance(const std::vector<CorrelatedEffects>& effects) {
  double sum = 0;
  for (const CorrelatedEffects& e : effects) sum += e.weight * e.variance(0);
  return sum;
}

TEST(CorrelatedEffects, TellsIndependentErrorsFromThoseThatGoTogether) {
  const Eigen::VectorXd start = Eigen::VectorXd::Constant(1, 0.01);
  double variance = 0, independence = 0;
  constexpr int kRuns = 20;
  for (unsigned seed = 1; seed <= kRuns; ++seed) {
    const auto alone = correlatedEffects(line(30, 0.3, 0, 0.1, seed), {1}, start, 0.01);
    independence += weightOfIndependence(alone) / kRuns;
    variance += meanVariance(alone) / kRuns;
    EXPECT_LT(weightOfIndependence(correlatedEffects(line(30, 0.3, 0.95, 0.1, seed), {1}, start, 0.01)), 0.01) << seed;
  }
  EXPECT_GT(independence, 0.7);
  EXPECT_NEAR(variance, 0.09, 0.09 * 0.12);  // 1,200 numbers tell it to 4 %: three of those
}

TEST(CorrelatedEffects, Scale) {
  std::vector<ViewCoefficients> views = line(10, 0.3, 0.9, 0.1, 3);
  const auto before = correlatedEffects(views, {1}, Eigen::VectorXd::Constant(1, 0.01), 0.01);
  for (ViewCoefficients& v : views) v.value *= 1000, v.where *= 1e-4;
  const auto after = correlatedEffects(views, {1}, Eigen::VectorXd::Constant(1, 1e4), 1e4);
  ASSERT_EQ(before.size(), after.size());
  for (std::size_t i = 0; i < before.size(); ++i) {
    EXPECT_NEAR(after[i].weight, before[i].weight, 1e-6);
    EXPECT_NEAR(after[i].variance(0), 1e6 * before[i].variance(0), 1e-6 * after[i].variance(0));
  }
}

TEST(CorrelatedEffects, DegenerateViewsKeepTheVariancesGiven) {
  const Eigen::VectorXd start = Eigen::VectorXd::Constant(1, 0.04);
  const auto expectGiven = [&](const std::vector<CorrelatedEffects>& e) {
    ASSERT_EQ(e.size(), 1u);
    EXPECT_EQ(e[0].length, 0);
    EXPECT_EQ(e[0].weight, 1);
    EXPECT_EQ(e[0].variance(0), 0.04);
  };
  expectGiven(correlatedEffects(line(3, 0.3, 0.9, 0.1, 1), {1}, start, 0.01));
  std::vector<ViewCoefficients> views = line(8, 0.3, 0.9, 0.1, 1);
  for (ViewCoefficients& v : views) v.where.setZero();
  expectGiven(correlatedEffects(views, {1}, start, 0.01));
  views = line(8, 0, 0, 0, 1);  // no residuals
  expectGiven(correlatedEffects(views, {1}, start, 0));
  views = line(8, 0.3, 0.9, 0.1, 1);
  for (const double none : {std::nan(""), 1e200}) {  // the likelihood of 1e200 overflows
    for (ViewCoefficients& v : views) v.value.setConstant(none);
    expectGiven(correlatedEffects(views, {1}, start, 0.01));  // a band must not vanish where nothing can be told
  }
  EXPECT_EQ(viewCorrelation(0, 0), 0) << "two views at one place are independent where all are";
  EXPECT_EQ(viewCorrelation(0, 2), 1);
  EXPECT_EQ(viewCorrelation(3, 0), 0);
  EXPECT_EQ(viewCorrelation(3, std::numeric_limits<double>::infinity()), 1);
}

TEST(ViewEffects, DegenerateInputsStayFinite) {
  Simulated s = simulated(2, 0, 0, 1);  // nothing is off: no variance
  const Round other(0.9);
  const ViewEffects exact(s.views, 1);
  for (const double sigma : exact.sigmaPx(other.byParameter * s.chart, other.shapes, Eigen::VectorXd::Constant(1, kBeyond)))
    EXPECT_LT(sigma, 1e-10);
  EXPECT_EQ(contourShapes({Pixel(1, 0), Pixel(0, 1), Pixel(-1, 0)}, {0, 0.3, 0.6}).columns.cols(), 1)
      << "three points: an offset is all they tell";
  EXPECT_EQ(contourShapes({}, {}).columns.cols(), 0);
  EXPECT_THROW(ViewEffects({}, 1), std::invalid_argument);
}

// --- the whole pipeline
// -----------------------------------------------------------------------------------------------------------

InspectionRequest request(double noise) {
  InspectionRequest q;
  q.models = {"limit-angle"};
  q.train = "0-5";
  q.noisePx = noise;
  q.settings.set("predict.band", true);
  return q;
}

TEST(Band, HoldsPosesThatAreOff) {
  double in = 0, count = 0, sigma = 0;
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const auto scene = exactScene(sheet(0.4), 12);
    std::mt19937_64 engine(seed);
    std::normal_distribution<double> gauss(0, 0.5 / 800);  // half a pixel
    for (Frame& f : scene->frames) {
      const Eigen::Vector3d turn(gauss(engine), gauss(engine), gauss(engine));
      f.camera.camFromWorld = Eigen::AngleAxisd(turn.norm(), turn.normalized()) * f.camera.camFromWorld;
    }
    InspectionRequest q = request(0.1);
    q.seed = seed;
    for (const bool refine : {false, true}) {
      q.settings.set("light.refine_poses", refine);
      const Inspection r = inspect(scene, q);
      const std::optional<BandScore> score = bandSummary(r, r.models.at("limit-angle"));
      ASSERT_TRUE(score);
      in += score->coverage;
      sigma += score->sigmaPx;
      count += 1;
    }
  }
  EXPECT_GT(in / count, 0.85);
  EXPECT_GT(sigma / count, 0.2) << "the pose of the view to predict is off by half a pixel itself";
}

TEST(Band, HoldsAScaleThatIsOffByItsTolerance) {
  constexpr double kOff = 0.01;
  const auto scene = exactScene(sphere(1), 12);
  AnalyticSpec& body = *scene->surfaces["body"].analytic();
  // Away from the origin, about which the scale is off: the scene moved as a whole looks the same.
  const Eigen::Translation3d away(0, 0, 1);
  body.worldFromSurface = away * body.worldFromSurface;
  for (Frame& f : scene->frames) f.camera.camFromWorld = f.camera.camFromWorld * away.inverse();
  body.radius *= 1 + kOff;  // contours are those of the surface as it is
  body.worldFromSurface.translation() *= 1 + kOff;
  InspectionRequest q = request(0.1);
  const Inspection silent = inspect(scene, q);
  q.settings.set("input.scale_tolerance", kOff);
  const Inspection stated = inspect(scene, q);
  const BandScore without = *bandSummary(silent, silent.models.at("limit-angle")),
                  with = *bandSummary(stated, stated.models.at("limit-angle"));
  EXPECT_LT(without.coverage, 0.8) << "the contours do not show a scale, or this scene is no test";
  EXPECT_GT(with.coverage, 0.85);
  double error = 0, count = 0;
  for (const FrameComparison& c : stated.models.at("limit-angle").frames)
    if (stated.isHeldOut(c.frame))
      for (const FrameComparison::Row& row : c.rows) error += row.metrics->contourErrorPx, count += 1;
  EXPECT_LT(with.sigmaPx, 3 * error / count) << "not wider than it must be";
  const std::vector<std::string> lines = bandLines(stated, stated.models.at("limit-angle"));
  EXPECT_TRUE(std::any_of(lines.begin(), lines.end(), [](const std::string& l) {
    return l.find("scale of the surface off by up to 1 %") != std::string::npos;
  }));
}

// The lobe that was asked for is that of the model reflectance. What the limit angle gets wrong is told by the lobe that fits.
TEST(Band, OfTheLimitAngleDoesNotDependOnTheLobeAskedFor) {
  const auto scene = exactScene(sphere(0.5), 12);
  InspectionRequest chosen = request(0.1), wrong = request(0.1);
  wrong.settings.set("fit.lobe", std::string("phong"));
  const Inspection a = inspect(scene, chosen), b = inspect(scene, wrong);
  EXPECT_EQ(bandSummary(a, a.models.at("limit-angle"))->sigmaPx, bandSummary(b, b.models.at("limit-angle"))->sigmaPx);
}

TEST(Band, SaysThatAClippedHighlightTellsNoLevel) {
  const auto scene = exactScene(sheet(0.4), 9);
  const auto widest = [](const Inspection& r) { return bandSummary(r, r.models.at("limit-angle"))->sigmaPx; };
  const Inspection plain = inspect(scene, request(0.1));
  for (Frame& f : scene->frames)
    for (Highlight& h : f.highlights) h.clipped = true;
  const Inspection clipped = inspect(scene, request(0.1));
  EXPECT_GT(widest(clipped), 20 * widest(plain));
  const std::vector<std::string> lines = bandLines(clipped, clipped.models.at("limit-angle"));
  EXPECT_TRUE(
      std::any_of(lines.begin(), lines.end(), [](const std::string& l) { return l.find("clipped") != std::string::npos; }));
}

TEST(Band, IsNotComputedUnlessAskedFor) {
  InspectionRequest q = request(0.1);
  q.settings.reset("predict.band");
  const Inspection r = inspect(exactScene(sheet(0.4), 9), q);
  EXPECT_FALSE(bandSummary(r, r.models.at("limit-angle")));
  EXPECT_TRUE(bandLines(r, r.models.at("limit-angle")).empty());
}

}  // namespace
}  // namespace glint
