// SPDX-License-Identifier: BSD-3-Clause
#include "core/reflectance/radiance_problem.h"

#include <ceres/ceres.h>

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <memory>

#include "core/base/numeric.h"
#include "core/base/solver_trace.h"
#include "core/light/dense_solver.h"
#include "core/reflectance/light_radiance.h"
#include "core/reflectance/radiance_field.h"
#include "core/reflectance/root_cost.h"

namespace glint::lobe {
namespace {

constexpr int kMaxReweightings = 8;
constexpr double kScanStepPx = 24;  // of the search for a frame's maximum when the light has moved far
constexpr int kMaxFootSteps = 4;
constexpr double kFootPx = 1e-4;  // a foot this close serves: its error enters the residual in second order
constexpr double kFarthestFootPx = 8;
constexpr double kSigmaOfMedian = 1.4826;  // standard deviation over median absolute deviation of a normal distribution
constexpr double kWidestRoughness = 3;     // roughness of a lobe that falls to half at 70 degrees and more: no highlight
constexpr double kNoiseShare = 1.2;        // of the noise's sigma: what a right lobe leaves of it, with some reserve
constexpr double kSagittaPx = 0.02;        // of contours as polylines
constexpr double kExactPx = 1e-7;          // residuals of round-off, of which no step can be told better than another
constexpr double kNearlySettled = 1e-6;    // change by which a round may end that was cut off: far below what noise does
constexpr double kSettled = 1e-9;          // change of the unit vector L and of log m between reweightings
constexpr int kFirstRoundIterations = 30;  // fits that explain their contours need 3 to 20; others creep along a valley

/// The maxima follow the light before every evaluation.
class PeaksFollow : public ceres::EvaluationCallback {
 public:
  PeaksFollow(RadianceProblem& problem, const State& state) : problem_(problem), state_(state) {}
  void PrepareForEvaluation(bool, bool newPoint) override {
    if (newPoint) problem_.updatePeaks(state_, false);
  }

 private:
  RadianceProblem& problem_;
  const State& state_;  ///< what Ceres writes before it calls
};

}  // namespace

RadianceProblem::RadianceProblem(Lobe lobe, const std::vector<RadianceView>& views, ContourEvidence evidence,
                                 const RadianceFitOptions& options)
    : lobe_(lobe),
      views_(views),
      points_(std::move(evidence.points)),
      frames_(std::move(evidence.frames)),
      origin_(evidence.origin),
      scale_(evidence.scale),
      radiusPx_(evidence.radiusPx),
      options_(options) {}

State RadianceProblem::start(const Lamp& lamp, const Roughness& roughness) const {
  return {normalised(lamp, origin_, scale_), std::log(roughness.mean), hasTwoWidths(lobe_) ? std::log(roughness.ratio) : 0};
}

Lamp RadianceProblem::inWorld(const State& state) const { return fromNormalised(state.lamp, origin_, scale_); }

bool RadianceProblem::tooWide(const State& state) { return !(state.logRoughness < std::log(kWidestRoughness)); }

double RadianceProblem::robust(double r) const {
  return r <= options_.robustPx ? r * r : options_.robustPx * (2 * r - options_.robustPx);
}

bool RadianceProblem::explains(const Attempt& a, double share) const {
  return a.converged && !tooWide(a.state) && excess(a, share) <= 1;
}

double RadianceProblem::excess(const Attempt& a, double share) const {
  const double farPx = std::max(options_.robustPx, share * radiusPx_), noise = kNoiseShare * a.noisePx;
  return a.cost / ((farPx * farPx + robust(noise)) * double(points_.size()));
}

bool RadianceProblem::leavesNoiseOnly(const Attempt& a) const {
  return a.converged && a.cost <= robust(std::max(kNoiseShare * a.noisePx, kSagittaPx)) * double(points_.size());
}

std::size_t RadianceProblem::lit() const {
  return std::count_if(frames_.begin(), frames_.end(), [](const FramePeak& f) { return f.at.has_value(); });
}

void RadianceProblem::updateLogs(const State& state) {
  for (FramePeak& f : frames_) f.log = f.at ? logAndSlopes(*this, *f.at, state) : std::nullopt;
}

void RadianceProblem::updatePeaks(const State& state, bool scan) {
  const Roughness roughness = state.roughness();
  if (!std::isfinite(roughness.mean) || !(roughness > 0) || !state.isFinite()) return;
  const Lamp lamp = inWorld(state);
  for (FramePeak& f : frames_) {
    const RadianceField field(*f.surface, f.camera, lobe_, roughness, lamp, rule_);
    const auto scanned = [&] {
      if (!f.scan) f.scan = coarseScan(*f.surface, f.camera, kScanStepPx);
      return field.peaks(f.starts, *f.scan);
    };
    std::vector<RadiancePeak> peaks = scan ? scanned() : field.peaks(f.starts, 0);
    if (peaks.empty() && !scan) peaks = scanned();
    if (peaks.empty()) {
      f.at.reset();
      continue;
    }
    const SurfacePoint& p = peaks.front().point;
    f.at = seenFrom(f.camera.centreInWorld(), *f.surface, p);
    f.at->position = (p.position - origin_) / scale_;
    // Climb from the places of these maxima next time: cheaper, and a second one may become the strongest.
    if (scan) {
      f.starts.clear();
      for (const RadiancePeak& k : peaks) f.starts.push_back(k.pixel);
    } else {
      f.starts.front() = peaks.front().pixel;
    }
  }
  updateLogs(state);
}

/// g at a point under the state of the last updatePeaks(); NaN where it is undefined.
double RadianceProblem::root(const Evidence& e, const Seen& s, const State& state) const {
  const std::optional<LogAndSlopes>& peak = frame(e.frame).log;
  const auto here = logOfLamp<double>(lobe_, state.roughness(), s.position, s.axes, s.toCamera, state.lamp, rule_);
  return here && peak ? rootOf(peak->value - *here, e.level) : std::numeric_limits<double>::quiet_NaN();
}

Eigen::Vector2d RadianceProblem::gradient(const Evidence& e, const Stencil& s, const State& state) const {
  return {(root(e, s.right, state) - root(e, s.left, state)) / (2 * s.stepPx),
          (root(e, s.down, state) - root(e, s.up, state)) / (2 * s.stepPx)};
}

double RadianceProblem::residual(const Evidence& e, const State& state) const {
  return e.offsetPx - e.biasPx + e.pixelsPerUnit * (root(e, e.foot.at, state) - e.level);
}

/// Moves the foot to the point of the contour nearest to the measured pixel: Newton's method along the gradient.
void RadianceProblem::toFoot(Evidence& e, const State& state) const {
  Pixel foot = e.observed;
  Stencil s = e.measured;
  for (int step = 0; step < kMaxFootSteps; ++step) {
    const Eigen::Vector2d slope = gradient(e, s, state);
    const double value = root(e, s.at, state) - e.level + slope.dot(e.observed - foot);
    const Pixel next = e.observed - value / slope.squaredNorm() * slope;
    // An outlier, or a start far off: the plain residual serves.
    if (!next.allFinite() || (next - e.observed).norm() > kFarthestFootPx) return;
    const std::optional<Stencil> there = look(views_[static_cast<std::size_t>(e.view)], next, origin_, scale_, s.stepPx);
    if (!there) return;
    const double moved = (next - foot).norm();
    foot = next;
    s = *there;
    if (moved < kFootPx) break;
  }
  const Eigen::Vector2d slope = gradient(e, s, state);
  const double offset = slope.normalized().dot(e.observed - foot);
  if (!std::isfinite(offset)) return;
  e.foot = s;
  e.offsetPx = offset;
}

void RadianceProblem::relinearise(const State& state, bool moveFeet) {
  std::vector<double> slopes;
  slopes.reserve(points_.size());
  for (Evidence& e : points_) {
    e.foot = e.measured;
    e.offsetPx = e.biasPx = 0;
    if (moveFeet) toFoot(e, state);
    const double slope = gradient(e, e.foot, state).norm();
    slopes.push_back(std::isfinite(slope) ? slope : 0);
  }
  // Where the field hardly changes over the image (a start far off) a pixel must not weigh without bound.
  const double floor = std::max(0.05 * upperMedian(slopes), 1e-12);
  for (std::size_t i = 0; i < points_.size(); ++i) points_[i].pixelsPerUnit = 1 / std::max(slopes[i], floor);
  if (moveFeet) unbias(state);
}

/// Independent noise of sigma px per coordinate puts pixels on average sigma^2 / 2 times the curvature outside a convex contour:
/// along the contour it leads off the curve, always to the same side. Sigma is the robust spread of the residuals. Contours whose
/// error is along their normal only have no such bias; their sigma is far below a pixel and the correction with it.
/// @see Kanatani and Rangarajan, Hyper least squares fitting of circles and ellipses, CSDA 2011 (the second-order bias).
void RadianceProblem::unbias(const State& state) {
  std::vector<double> sizes;
  sizes.reserve(points_.size());
  for (Evidence& e : points_) {
    e.biasPx = 0;
    const double r = std::abs(residual(e, state));
    if (std::isfinite(r)) sizes.push_back(r);
  }
  if (sizes.empty()) return;
  const double sigma = kSigmaOfMedian * upperMedian(sizes);
  // Beyond a radius of curvature the expansion in sigma says nothing more.
  for (Evidence& e : points_) e.biasPx = 0.5 * sigma * std::min(1.0, sigma * e.curvature);
}

double RadianceProblem::robustCost(const State& state) const {
  double sum = 0;
  for (const Evidence& e : points_) {
    const double plain = std::abs(residual(e, state));
    sum += robust(std::isfinite(plain) ? plain : kUnlitPx);
  }
  return std::isfinite(sum) ? sum : std::numeric_limits<double>::infinity();
}

/// Robust sigma of the residuals' second differences along the contours: what a wrong light or lobe leaves is smooth there, noise
/// of the points is not.
double RadianceProblem::noiseOf(const State& state) const {
  std::vector<double> differences;
  for (std::size_t i = 1; i + 1 < points_.size(); ++i) {
    if (points_[i - 1].view != points_[i + 1].view) continue;
    const double d = residual(points_[i - 1], state) - 2 * residual(points_[i], state) + residual(points_[i + 1], state);
    if (std::isfinite(d)) differences.push_back(std::abs(d) / std::sqrt(6.0));
  }
  if (differences.empty()) return 0;
  return kSigmaOfMedian * upperMedian(differences);
}

void RadianceProblem::chooseRule(const State& state) {
  largestRatio_ = 0;
  if (!state.lamp.isPoint())
    for (const Evidence& e : points_)
      largestRatio_ = std::max(largestRatio_, lampRatio(state.roughness(), e.foot.at.position, e.foot.at.toCamera, state.lamp));
  const double reserve = std::visit([](const auto& shape) { return shape.kRatioReserve; }, state.lamp.shape);
  rule_ = lampRuleFor(state.lamp.shape, reserve * largestRatio_);
}

bool RadianceProblem::tooLarge(const State& state) const {
  return std::visit(
      [&](const auto& shape) { return largestRatio_ > shape.kLargestRatio || (!shape.kMayVanish && !(shape.reach() > 0)); },
      state.lamp.shape);
}

void RadianceProblem::settle(const State& state) {
  chooseRule(state);
  updatePeaks(state, true);
  relinearise(state, true);
}

Attempt RadianceProblem::solve(const State& start) {
  const auto light = [&](const State& s) {
    Eigen::Vector4d world;
    world << scale_ * s.lamp.centre.head<3>() + s.lamp.centre.w() * origin_, s.lamp.centre.w();
    return world;
  };
  TracedRun run("lamp and lobe from contours", light(start));
  const Attempt a = solveFrom(start);
  run.end(a.converged,
          !std::isfinite(a.cost) ? "no usable step"
          : a.converged          ? "at a minimum"
                                 : "out of iterations",
          light(a.state));
  return a;
}

Attempt RadianceProblem::solveFrom(const State& start) {
  Attempt a;
  a.state = start;
  const LampShape& shape = a.state.lamp.shape;
  const int most = std::min(std::visit([](const auto& s) { return s.kMostSteps; }, shape), options_.maxIterations);
  for (int round = 0; round < kMaxReweightings && a.iterations < most; ++round) {
    // The weights are held while the light moves: a residual whose own weight moves would prefer lights under which the field is
    // steep.
    chooseRule(a.state);
    if (tooLarge(a.state)) return Attempt{};
    updatePeaks(a.state, true);
    if (lit() == 0) return a;
    relinearise(a.state, round > 0);
    const Eigen::VectorXd before = a.state.place();
    PeaksFollow follow(*this, a.state);
    ceres::Problem::Options ownership;
    ownership.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    ownership.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    ownership.disable_all_safety_checks = true;
    ownership.evaluation_callback = &follow;
    // The first round may start far off, where every point would be an outlier.
    ceres::HuberLoss loss(round == 0 ? std::max(options_.robustPx, radiusPx_) : options_.robustPx);
    std::vector<std::unique_ptr<ceres::CostFunction>> costs;
    DenseSolution solution;
    {
      ceres::Problem problem(ownership);
      const std::vector<double*> blocks = Blocks(a.state, lobe_).used();
      for (const Evidence& e : points_)
        problem.AddResidualBlock(costs.emplace_back(rootCost(shape, *this, e)).get(), &loss, blocks);
      if (a.state.atInfinity())
        problem.SetManifold(blocks[0], new ceres::ProductManifold<ceres::SphereManifold<3>, ceres::SubsetManifold>(
                                           ceres::SphereManifold<3>(), ceres::SubsetManifold(1, {0})));
      else
        problem.SetManifold(blocks[0], new ceres::SphereManifold<4>());
      if (options_.holdLamp) problem.SetParameterBlockConstant(blocks[0]);
      if (options_.holdLamp && unknownCount(shape) > 0) problem.SetParameterBlockConstant(blocks[2]);
      // Keeps the derivative of a square root finite.
      const double least = std::visit([](const auto& s) { return s.kLeast; }, shape);
      if (least > 0) problem.SetParameterLowerBound(blocks[2], 0, least);
      // The frame's maximum is searched again at every step: no unknown settles below the 1e-11 or so to which it is found. The
      // cost: of a sum of squares over hundreds of points, thousandths of a standard deviation.
      solution = solveDense(problem, round == 0 ? std::min(most, kFirstRoundIterations) : most - a.iterations, 1e-11, 1e-10,
                            options_.progress);
    }
    a.iterations += solution.iterations;
    if (!solution.usable || !a.state.isFinite()) return a;
    const double change = (a.state.place() - before).norm();
    a.converged = solution.converged || solution.cost <= kExactPx * kExactPx * double(points_.size()) || change < kNearlySettled;
    if (a.converged && change < kSettled) break;
    if (round == 0 && !a.converged && a.iterations == kFirstRoundIterations) {
      if (!judge(a)) return Attempt{};
      if (excess(a, kPoorShare) > kHopeless) return a;
    }
  }
  return judge(a) ? a : Attempt{};
}

/// Cost and noise of a state with its own maxima, feet and weights; false where its lamp is too large.
bool RadianceProblem::judge(Attempt& a) {
  chooseRule(a.state);
  if (tooLarge(a.state)) return false;
  updatePeaks(a.state, true);
  relinearise(a.state, true);
  a.cost = robustCost(a.state);
  a.noisePx = noiseOf(a.state);
  return true;
}

RadianceProblem::Probe RadianceProblem::probe(State state, const std::vector<ProbeColumn>& columns) {
  Eigen::Matrix<double, 4, 3, Eigen::RowMajor> chart;
  ceres::SphereManifold<4>().PlusJacobian(state.lamp.centre.data(), chart.data());
  const Eigen::Index n = points(), extra = static_cast<Eigen::Index>(columns.size());
  Eigen::MatrixXd jacobian(n, 4 + extra);
  Eigen::VectorXd residuals(n);
  const auto values = [&](State s) {
    updateLogs(s);
    const Blocks blocks(s, lobe_);
    Eigen::VectorXd v(n);
    for (Eigen::Index i = 0; i < n; ++i) (void)rootCost(s.lamp.shape, *this, points_[i])->Evaluate(blocks.at, &v(i), nullptr);
    return v;
  };
  for (Eigen::Index k = 0; k < extra; ++k) {
    chooseRule(columns[k].grown);
    jacobian.col(4 + k) = values(columns[k].grown) - values(columns[k].plain);
  }
  updateLogs(state);
  const Blocks blocks(state, lobe_);
  for (Eigen::Index i = 0; i < n; ++i) {
    double byRoughness = 0;
    Eigen::RowVector4d byLight;
    double* slopes[] = {byLight.data(), &byRoughness, nullptr};
    (void)rootCost(PointShape<>{}, *this, points_[i])->Evaluate(blocks.at, &residuals(i), slopes);
    jacobian.row(i).head<4>() << byLight * chart, byRoughness;
  }
  const Eigen::VectorXd step = jacobian.colPivHouseholderQr().solve(-residuals);
  return {residuals.squaredNorm() - (residuals + jacobian * step).squaredNorm(), step.tail(extra)};
}

std::vector<double> RadianceProblem::rmsOfViews(const State& state, std::size_t views) {
  settle(state);
  std::vector<double> sums(views, 0);
  std::vector<int> counts(views, 0);
  for (const Evidence& e : points_) {
    const double r = residual(e, state);
    sums[e.view] += r * r;  // not finite where nothing is lit
    ++counts[e.view];
  }
  for (std::size_t v = 0; v < views; ++v) sums[v] = std::sqrt(sums[v] / counts[v]);
  return sums;
}

}  // namespace glint::lobe
