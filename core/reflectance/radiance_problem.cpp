// SPDX-License-Identifier: BSD-3-Clause
#include "core/reflectance/radiance_problem.h"

#include <ceres/ceres.h>

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <memory>

#include "core/base/median.h"
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
constexpr double kSigmaOfMedian = 1.4826;      // standard deviation over median absolute deviation of a normal distribution
constexpr double kWidestRoughness = 3;         // roughness of a lobe that falls to half at 70 degrees and more: no highlight
constexpr double kNoiseShare = 1.2;            // of the noise's sigma: what a right lobe leaves of it, with some reserve
constexpr double kSagittaPx = 0.02;            // of contours as polylines
constexpr double kExactPx = 1e-7;              // residuals of round-off, of which no step can be told better than another
constexpr double kNearlySettled = 1e-6;        // change by which a round may end that was cut off: far below what noise does
constexpr double kSettled = 1e-9;              // change of the unit vector L and of log m between reweightings
constexpr double kProbeRadius = 0.4;           // of the lobe's width, as angles of the light: one that would show little
constexpr double kLeastRadiusSquared = 1e-10;  // normalised: keeps the square root's derivative finite
// In lobe widths: beyond it contours show the lamp and hardly the lobe, and sums over a disc take minutes.
constexpr double kLargestSphere = 2.5, kLongestSegment = 12;
constexpr int kSphereIterations = 25;      // a size that is there is found in a dozen; a wrong lobe creeps along a valley
constexpr int kSegmentIterations = 60;     // three unknowns more, from starts that are far off
constexpr int kFirstRoundIterations = 30;  // fits that explain their contours need 3, at most 20; others creep along a valley
constexpr double kRatioReserve = 1.3;      // a segment may grow within a round

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

State RadianceProblem::start(const Lamp& lamp, double roughness) const {
  State s;
  const LampIn<double> in = lobe::inWorld(lamp);
  s.shape = in.shape;
  Eigen::Vector4d l;
  l << (in.light.head<3>() - in.light.w() * origin_) / scale_, in.light.w();
  require(l.norm() > 0, "fitRadiance: no light");
  s.at.head<4>() = l.normalized();
  s.at(kLogRoughness) = std::log(roughness);
  s.at(kRadiusSquared) = in.radiusSquared / (scale_ * scale_);
  s.at.tail<3>() = in.halfAxis / scale_;
  return s;
}

Lamp RadianceProblem::inWorld(const State& state) const {
  Eigen::Vector4d world;
  world << scale_ * state.at.head<3>() + state.at(3) * origin_, state.at(3);
  Lamp lamp(Light::homogeneous(world));
  if (state.shape == LampShape::Sphere) lamp.radius = scale_ * std::sqrt(std::max(0.0, state.at(kRadiusSquared)));
  if (state.shape == LampShape::Segment) lamp.halfAxis = scale_ * state.at.tail<3>();
  return lamp;
}

bool RadianceProblem::tooWide(const State& state) { return !(state.at(kLogRoughness) < std::log(kWidestRoughness)); }

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
  const double roughness = state.roughness();
  if (!std::isfinite(roughness) || !(roughness > 0) || !state.at.allFinite()) return;
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
    f.at = Seen{(p.position - origin_) / scale_, p.normal, (f.camera.centreInWorld() - p.position).normalized()};
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

/// g at a point, under the state of the last updatePeaks(); NaN where it is undefined.
double RadianceProblem::root(const Evidence& e, const Seen& s, const State& state) const {
  const std::optional<LogAndSlopes>& peak = frame(e.frame).log;
  const auto here = logOfLamp<double>(lobe_, state.roughness(), s.position, s.normal, s.toCamera, state.lamp(), rule_);
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
  const LampIn<double> lamp = state.lamp();
  if (lamp.shape != LampShape::Point)
    for (const Evidence& e : points_)
      largestRatio_ = std::max(largestRatio_, lampRatio(state.roughness(), e.foot.at.position, e.foot.at.toCamera, lamp));
  rule_ = lampRuleFor(lamp.shape, lamp.shape == LampShape::Segment ? kRatioReserve * largestRatio_ : largestRatio_);
}

bool RadianceProblem::tooLarge(const State& state) const {
  return (state.shape == LampShape::Sphere && largestRatio_ > kLargestSphere) ||
         (state.shape == LampShape::Segment && (largestRatio_ > kLongestSegment || !(state.at.tail<3>().squaredNorm() > 0)));
}

/// Rule, maxima, feet and weights of a state.
void RadianceProblem::settle(const State& state) {
  chooseRule(state);
  updatePeaks(state, true);
  relinearise(state, true);
}

Attempt RadianceProblem::solve(const State& start) {
  const auto light = [&](const State& s) {
    Eigen::Vector4d world;
    world << scale_ * s.at.head<3>() + s.at(3) * origin_, s.at(3);
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
  Parameters& at = a.state.at;
  const LampShape shape = start.shape;
  const int limit = shape == LampShape::Sphere ? kSphereIterations : kSegmentIterations;
  const int most = shape == LampShape::Point ? options_.maxIterations : std::min(limit, options_.maxIterations);
  for (int round = 0; round < kMaxReweightings && a.iterations < most; ++round) {
    // The weights are held while the light moves: a residual whose own weight moves gains by lights under which the field is
    // steep.
    chooseRule(a.state);
    if (tooLarge(a.state)) return Attempt{};
    updatePeaks(a.state, true);
    if (lit() == 0) return a;
    relinearise(a.state, round > 0);
    const Parameters before = at;
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
      std::vector<double*> blocks{at.data(), at.data() + kLogRoughness};
      if (shape != LampShape::Point) blocks.push_back(at.data() + shapeStart(shape));
      for (const Evidence& e : points_)
        problem.AddResidualBlock(costs.emplace_back(rootCost(shape, *this, e)).get(), &loss, blocks);
      if (a.state.atInfinity())
        problem.SetManifold(at.data(), new ceres::ProductManifold<ceres::SphereManifold<3>, ceres::SubsetManifold>(
                                           ceres::SphereManifold<3>(), ceres::SubsetManifold(1, {0})));
      else
        problem.SetManifold(at.data(), new ceres::SphereManifold<4>());
      if (shape == LampShape::Sphere) problem.SetParameterLowerBound(at.data() + kRadiusSquared, 0, kLeastRadiusSquared);
      // The frame's maximum is searched again at every step: no unknown settles below the 1e-11 or so to which it is found. The cost: of a sum
      // of squares over hundreds of points, thousandths of a standard deviation.
      solution = solveDense(problem, round == 0 ? std::min(most, kFirstRoundIterations) : most - a.iterations, 1e-11, 1e-10,
                            options_.progress);
    }
    a.iterations += solution.iterations;
    if (!solution.usable || !at.allFinite()) return a;
    a.converged = solution.converged || solution.cost <= kExactPx * kExactPx * double(points_.size()) ||
                  (at - before).norm() < kNearlySettled;
    if (a.converged && (at - before).norm() < kSettled) break;
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

RadianceProblem::Probe RadianceProblem::probe(const State& state, const std::vector<ProbeColumn>& columns) {
  Eigen::Matrix<double, 4, 3, Eigen::RowMajor> chart;
  ceres::SphereManifold<4>().PlusJacobian(state.at.data(), chart.data());
  const Eigen::Index n = points(), extra = static_cast<Eigen::Index>(columns.size());
  Eigen::MatrixXd jacobian(n, 4 + extra);
  Eigen::VectorXd residuals(n);
  const auto values = [&](const State& s) {
    updateLogs(s);
    const Blocks blocks(s);
    Eigen::VectorXd v(n);
    for (Eigen::Index i = 0; i < n; ++i) (void)rootCost(s.shape, *this, points_[i])->Evaluate(blocks.at, &v(i), nullptr);
    return v;
  };
  for (Eigen::Index k = 0; k < extra; ++k) {
    chooseRule(columns[k].grown);
    jacobian.col(4 + k) = values(columns[k].grown) - values(columns[k].plain);
  }
  updateLogs(state);
  const Blocks blocks(state);
  for (Eigen::Index i = 0; i < n; ++i) {
    double byRoughness = 0;
    Eigen::RowVector4d byLight;
    double* slopes[] = {byLight.data(), &byRoughness, nullptr};
    (void)rootCost(LampShape::Point, *this, points_[i])->Evaluate(blocks.at, &residuals(i), slopes);
    jacobian.row(i).head<4>() << byLight * chart, byRoughness;
  }
  const Eigen::VectorXd step = jacobian.colPivHouseholderQr().solve(-residuals);
  return {residuals.squaredNorm() - (residuals + jacobian * step).squaredNorm(), step.tail(extra)};
}

double RadianceProblem::gainBySize(const Attempt& a) {
  if (a.state.atInfinity()) return 0;  // there a size has no meaning, only an angle
  State grown = a.state;
  grown.shape = LampShape::Sphere;
  grown.at(kRadiusSquared) = std::pow(kProbeRadius * a.state.roughness() * a.state.at.head<3>().norm() / a.state.at(3), 2);
  const Probe found = probe(a.state, {{grown, a.state}});
  return found.extra(0) > 0 ? found.gain : 0;
}

RadianceProblem::SegmentGain RadianceProblem::gainByLength(const State& point) {
  SegmentGain none;
  if (point.atInfinity()) return none;
  settle(point);
  // Second moments across the mean direction to the light; a length along it would hardly be seen.
  const Eigen::Vector3d towards = point.at.head<3>().normalized();
  const Eigen::Vector3d u = towards.unitOrthogonal(), v = towards.cross(u);
  const double length = kProbeRadius * point.roughness() * point.at.head<3>().norm() / point.at(3);
  std::vector<ProbeColumn> columns;
  for (const Eigen::Vector3d& axis : {u, v, Eigen::Vector3d((u + v) / std::sqrt(2.0))}) {
    // Against a segment too short to be seen: the sine of the angle to the axis is there for any length.
    ProbeColumn c{point, point};
    c.grown.shape = c.plain.shape = LampShape::Segment;
    c.grown.at.tail<3>() = length * axis;
    c.plain.at.tail<3>() = 1e-3 * length * axis;  // as good as a point
    columns.push_back(c);
  }
  const Probe found = probe(point, columns);
  Eigen::Matrix2d moment;  // of the lamp, over the probe's
  moment << found.extra(0) + 0.5 * found.extra(2), 0.5 * found.extra(2), 0.5 * found.extra(2),
      found.extra(1) + 0.5 * found.extra(2);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(moment);
  if (!moment.allFinite() || !(eigen.eigenvalues()(1) > 0)) return none;
  const Eigen::Vector2d main = eigen.eigenvectors().col(1);
  return {found.gain, (main(0) * u + main(1) * v).normalized() * length * std::sqrt(eigen.eigenvalues()(1))};
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
