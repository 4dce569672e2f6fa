// SPDX-License-Identifier: BSD-3-Clause
#include "core/reflectance/fit.h"

#include <ceres/ceres.h>
#include <ceres/jet.h>

#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>

#include "core/base/residual_spread.h"
#include "core/light/dense_solver.h"
#include "core/reflectance/contour_evidence.h"
#include "core/reflectance/light_radiance.h"
#include "core/reflectance/radiance_field.h"

namespace glint {
namespace {

constexpr int kMaxReweightings = 8;
constexpr double kScanStepPx = 24;  // of the search for a frame's maximum when the light has moved far
constexpr int kMaxFootSteps = 4;
constexpr double kFootPx = 1e-4;  // a foot this close serves: its error enters the residual in second order
constexpr double kFarthestFootPx = 8;
constexpr double kSigmaOfMedian = 1.4826;      // standard deviation over median absolute deviation of a normal distribution
constexpr double kUnlitPx = 100;               // residual of a point that the light does not reach
constexpr double kPoorShare = 0.1;             // of the radius: a wrong lobe leaves less, a wrong start leaves more
constexpr double kDoubtShare = 0.02;           // of the radius: a right lobe leaves less
constexpr double kWidest = 3;                  // roughness of a lobe that falls to half at 70 degrees and more: no highlight
constexpr double kNoiseShare = 1.2;            // of the noise's sigma: what a right lobe leaves of it, with some reserve
constexpr double kSagittaPx = 0.02;            // of contours as polylines
constexpr double kExactPx = 1e-7;              // residuals of round-off, of which no step can be told better than another
constexpr double kNearlySettled = 1e-6;        // change by which a round may end that was cut off: far below what noise does
constexpr double kProbeRadius = 0.4;           // of the lobe's width, as angles of the light: one that would show little
constexpr double kLeastRadiusSquared = 1e-10;  // normalised: keeps the square root's derivative finite
constexpr double kLargestSize = 2.5;          // in lobe widths: beyond it contours show the lamp and hardly the lobe, and sums over it take minutes
constexpr int kSizeIterations = 25;           // a size that is there is found in a dozen; a wrong lobe creeps along a valley
constexpr double kLeastGain = 0.2;             // of the sum of squares, before a size is believed
constexpr double kSettled = 1e-9;              // change of the unit vector L and of log m between reweightings
// Other starts are judged by a short fit to few points; the most promising are then fitted in full.
constexpr int kScreenPoints = 16, kScreenIterations = 15;
constexpr std::size_t kPromising = 3;

/// L (4), log m, and the squared radius of the light in normalised coordinates.
using Parameters = Eigen::Matrix<double, 6, 1>;
using Dual = ceres::Jet<double, 6>;

using lobe::ContourEvidence;
using lobe::Evidence;
using lobe::FramePeak;
using lobe::Seen;
using lobe::Stencil;

template <class T>
std::optional<T> logRadianceAt(Lobe lobe, const Seen& s, const Eigen::Matrix<T, 4, 1>& light, const T& roughness,
                               const T& radiusSquared, const lobe::DiscRule& rule) {
  return lobe::logOfSphereLight<T>(lobe, roughness, s.position, s.normal, s.toCamera, light, radiusSquared, rule);
}

/// sqrt(u), continued by its tangent below a quarter of the level's: a start far off may put a contour point above the peak.
template <class T>
T rootOf(const T& u, double level) {
  using std::sqrt;
  const double knee = 0.25 * level * level;
  return u > T(knee) ? T(sqrt(u)) : T(std::sqrt(knee)) + (u - T(knee)) / T(2 * std::sqrt(knee));
}

class Problem {
 public:
  Problem(Lobe lobe, const std::vector<RadianceView>& views, ContourEvidence evidence, const RadianceFitOptions& options)
      : lobe_(lobe),
        views_(views),
        points_(std::move(evidence.points)),
        frames_(std::move(evidence.frames)),
        origin_(evidence.origin),
        scale_(evidence.scale),
        radiusPx_(evidence.radiusPx),
        options_(options) {}

  struct Attempt {
    Parameters at = Parameters::Zero();
    double cost = std::numeric_limits<double>::infinity();
    double noisePx = 0;  ///< of the residuals that neighbours on a contour do not share
    int iterations = 0;
    bool converged = false;
  };
  /// Converged, with what remains below `share` of the radius, or the robust scale, once the noise is allowed for.
  bool explains(const Attempt& a, double share) const {
    const double farPx = std::max(options_.robustPx, share * radiusPx_), noise = kNoiseShare * a.noisePx;
    return a.converged && a.at(4) < std::log(kWidest) && a.cost <= (farPx * farPx + robust(noise)) * double(points_.size());
  }

  Attempt solve(const Eigen::Vector4d& light, double roughness, bool atInfinity) {
    Parameters start;
    start << light, std::log(roughness), 0;
    if (atInfinity) start(3) = 0;
    start.head<4>().normalize();
    return solve(start, false);
  }
  /// @param withSize  the light's radius is free too, from start(5) > 0; L must be finite.
  Attempt solve(const Parameters& start, bool withSize);
  /// By how much a light of some size would lower the sum of squares, to first order; 0 where it would raise it.
  double gainBySize(const Attempt& a);
  /// Nothing that neighbours on a contour share remains.
  bool leavesNoiseOnly(const Attempt& a) const {
    return a.converged && a.cost <= robust(std::max(kNoiseShare * a.noisePx, kSagittaPx)) * double(points_.size());
  }
  RadianceFit describe(const Attempt& a, std::size_t views);
  void setUncertainty(const Attempt& a, RadianceFit& fit) const;
  std::size_t lit() const {
    return std::count_if(frames_.begin(), frames_.end(), [](const FramePeak& f) { return f.at.has_value(); });
  }
  Light inWorld(const Eigen::Vector4d& light) const {
    Eigen::Vector4d world;
    world << scale_ * light.head<3>() + light.w() * origin_, light.w();
    return Light::homogeneous(world);
  }

  /// Finds every frame's maximum; `scan`: anywhere in the image, else uphill from the last one.
  void updatePeaks(const Parameters& at, bool scan) {
    const Light light = inWorld(at.head<4>());
    const double roughness = std::exp(at(4));
    if (!std::isfinite(roughness) || !(roughness > 0)) return;
    for (FramePeak& f : frames_) {
      const RadianceField field(*f.surface, f.camera, lobe_, roughness, light, scale_ * std::sqrt(at(5)));
      std::vector<RadiancePeak> peaks = field.peaks(f.starts, scan ? kScanStepPx : 0);
      if (peaks.empty() && !scan) peaks = field.peaks(f.starts, kScanStepPx);
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
  }

  const std::vector<Evidence>& points() const { return points_; }
  const FramePeak& frame(int i) const { return frames_[static_cast<std::size_t>(i)]; }
  Lobe lobe() const { return lobe_; }
  const lobe::DiscRule& rule() const { return *rule_; }
  /// The quadrature for lights up to that of `at`.
  void chooseRule(const Parameters& at);

 private:
  /// g at a point; NaN where it is undefined.
  double root(const Evidence& e, const Seen& s, const Parameters& at) const {
    const std::optional<Seen>& peak = frame(e.frame).at;
    const auto here = logRadianceAt<double>(lobe_, s, at.head<4>(), std::exp(at(4)), at(5), *rule_);
    const auto top = peak ? logRadianceAt<double>(lobe_, *peak, at.head<4>(), std::exp(at(4)), at(5), *rule_) : std::nullopt;
    return here && top ? rootOf(*top - *here, e.level) : std::numeric_limits<double>::quiet_NaN();
  }
  Eigen::Vector2d gradient(const Evidence& e, const Stencil& s, const Parameters& at) const {
    return {(root(e, s.right, at) - root(e, s.left, at)) / (2 * s.stepPx),
            (root(e, s.down, at) - root(e, s.up, at)) / (2 * s.stepPx)};
  }
  double residual(const Evidence& e, const Parameters& at) const {
    return e.offsetPx - e.biasPx + e.pixelsPerUnit * (root(e, e.foot.at, at) - e.level);
  }
  void relinearise(const Parameters& at, bool moveFeet);
  void unbias(const Parameters& at);
  void toFoot(Evidence& e, const Parameters& at) const;
  double robust(double r) const { return r <= options_.robustPx ? r * r : options_.robustPx * (2 * r - options_.robustPx); }
  double robustCost(const Parameters& at) const;
  double noiseOf(const Parameters& at) const;

  Lobe lobe_;
  const lobe::DiscRule* rule_ = &lobe::discRuleFor(0);
  double largestSize_ = 0;  ///< of the light at any point, in lobe widths
  const std::vector<RadianceView>& views_;
  std::vector<Evidence> points_;
  std::vector<FramePeak> frames_;
  Eigen::Vector3d origin_;
  double scale_;
  double radiusPx_;  ///< of the contours' regions, mean
  RadianceFitOptions options_;
};

/// (g - sqrt(-log q)) in pixels, with its derivatives by dual numbers.
class RootCost : public ceres::SizedCostFunction<1, 4, 1, 1> {
 public:
  RootCost(const Problem& problem, const Evidence& evidence) : problem_(problem), e_(evidence) {}
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    const std::optional<Dual> residual = residualOf(parameters);
    // A light that does not reach the point is far off: a large residual that pulls nowhere, so that the others decide.
    residuals[0] = residual ? residual->a : kUnlitPx;
    for (int i = 0; jacobians && jacobians[0] && i < 4; ++i) jacobians[0][i] = residual ? residual->v(i) : 0;
    for (int i = 0; jacobians && i < 2; ++i)
      if (jacobians[1 + i]) jacobians[1 + i][0] = residual ? residual->v(4 + i) : 0;
    return true;
  }

 private:
  std::optional<Dual> residualOf(double const* const* parameters) const {
    const std::optional<Seen>& peak = problem_.frame(e_.frame).at;
    if (!peak) return std::nullopt;
    Eigen::Matrix<Dual, 4, 1> light;
    for (int i = 0; i < 4; ++i) light(i) = Dual(parameters[0][i], i);
    const Dual roughness = exp(Dual(parameters[1][0], 4)), radiusSquared(parameters[2][0], 5);
    if (!(roughness.a > 0) || !std::isfinite(roughness.a)) return std::nullopt;
    const auto here = logRadianceAt<Dual>(problem_.lobe(), e_.foot.at, light, roughness, radiusSquared, problem_.rule());
    const auto top = logRadianceAt<Dual>(problem_.lobe(), *peak, light, roughness, radiusSquared, problem_.rule());
    if (!here || !top) return std::nullopt;
    const Dual residual =
        (rootOf(*top - *here, e_.level) - Dual(e_.level)) * Dual(e_.pixelsPerUnit) + Dual(e_.offsetPx - e_.biasPx);
    if (!std::isfinite(residual.a) || !residual.v.allFinite()) return std::nullopt;
    return residual;
  }

  const Problem& problem_;
  const Evidence& e_;
};

/// The maxima follow the light before every evaluation.
class PeaksFollow : public ceres::EvaluationCallback {
 public:
  PeaksFollow(Problem& problem, const Parameters& at) : problem_(problem), at_(at) {}
  void PrepareForEvaluation(bool, bool newPoint) override {
    if (newPoint) problem_.updatePeaks(at_, false);
  }

 private:
  Problem& problem_;
  const Parameters& at_;  ///< what Ceres writes before it calls
};

/// Moves the foot to the point of the contour nearest to the measured pixel: Newton's method along the gradient.
void Problem::toFoot(Evidence& e, const Parameters& at) const {
  Pixel foot = e.observed;
  Stencil s = e.measured;
  for (int step = 0; step < kMaxFootSteps; ++step) {
    const Eigen::Vector2d slope = gradient(e, s, at);
    const double value = root(e, s.at, at) - e.level + slope.dot(e.observed - foot);
    const Pixel next = e.observed - value / slope.squaredNorm() * slope;
    // An outlier, or a start far off: the plain residual serves.
    if (!next.allFinite() || (next - e.observed).norm() > kFarthestFootPx) return;
    const std::optional<Stencil> there = lobe::look(views_[static_cast<std::size_t>(e.view)], next, origin_, scale_, s.stepPx);
    if (!there) return;
    const double moved = (next - foot).norm();
    foot = next;
    s = *there;
    if (moved < kFootPx) break;
  }
  const Eigen::Vector2d slope = gradient(e, s, at);
  const double offset = slope.normalized().dot(e.observed - foot);
  if (!std::isfinite(offset)) return;
  e.foot = s;
  e.offsetPx = offset;
}

void Problem::relinearise(const Parameters& at, bool moveFeet) {
  std::vector<double> slopes;
  slopes.reserve(points_.size());
  for (Evidence& e : points_) {
    e.foot = e.measured;
    e.offsetPx = e.biasPx = 0;
    if (moveFeet) toFoot(e, at);
    const double slope = gradient(e, e.foot, at).norm();
    slopes.push_back(std::isfinite(slope) ? slope : 0);
  }
  std::vector<double> sorted = slopes;
  std::nth_element(sorted.begin(), sorted.begin() + sorted.size() / 2, sorted.end());
  // Where the field hardly changes over the image (a start far off) a pixel must not weigh without bound.
  const double floor = std::max(0.05 * sorted[sorted.size() / 2], 1e-12);
  for (std::size_t i = 0; i < points_.size(); ++i) points_[i].pixelsPerUnit = 1 / std::max(slopes[i], floor);
  if (moveFeet) unbias(at);
}

/// Independent noise of sigma px per coordinate puts pixels on average sigma^2 / 2 times the curvature outside a convex contour:
/// along the contour it leads off the curve, always to the same side. Sigma is the robust spread of the residuals. Contours whose
/// error is along their normal only have no such bias; their sigma is far below a pixel and the correction with it.
/// @see Kanatani and Rangarajan, Hyper least squares fitting of circles and ellipses, CSDA 2011 (the second-order bias).
void Problem::unbias(const Parameters& at) {
  std::vector<double> sizes;
  sizes.reserve(points_.size());
  for (Evidence& e : points_) {
    e.biasPx = 0;
    const double r = std::abs(residual(e, at));
    if (std::isfinite(r)) sizes.push_back(r);
  }
  if (sizes.empty()) return;
  std::nth_element(sizes.begin(), sizes.begin() + sizes.size() / 2, sizes.end());
  const double sigma = kSigmaOfMedian * sizes[sizes.size() / 2];
  // Beyond a radius of curvature the expansion in sigma says nothing more.
  for (Evidence& e : points_) e.biasPx = 0.5 * sigma * std::min(1.0, sigma * e.curvature);
}

double Problem::robustCost(const Parameters& at) const {
  double sum = 0;
  for (const Evidence& e : points_) {
    const double plain = std::abs(residual(e, at));
    sum += robust(std::isfinite(plain) ? plain : kUnlitPx);
  }
  return std::isfinite(sum) ? sum : std::numeric_limits<double>::infinity();
}

/// Robust sigma of the residuals' second differences along the contours: what a wrong light or lobe leaves is smooth there, noise
/// of the points is not.
double Problem::noiseOf(const Parameters& at) const {
  std::vector<double> differences;
  for (std::size_t i = 1; i + 1 < points_.size(); ++i) {
    if (points_[i - 1].view != points_[i + 1].view) continue;
    const double d = residual(points_[i - 1], at) - 2 * residual(points_[i], at) + residual(points_[i + 1], at);
    if (std::isfinite(d)) differences.push_back(std::abs(d) / std::sqrt(6.0));
  }
  if (differences.empty()) return 0;
  std::nth_element(differences.begin(), differences.begin() + differences.size() / 2, differences.end());
  return kSigmaOfMedian * differences[differences.size() / 2];
}

void Problem::chooseRule(const Parameters& at) {
  largestSize_ = 0;
  if (at(5) > 0)
    for (const Evidence& e : points_)
      largestSize_ = std::max(
          largestSize_, lobe::sizeRatio(std::exp(at(4)), e.foot.at.position, e.foot.at.toCamera, at.head<4>(), std::sqrt(at(5))));
  rule_ = &lobe::discRuleFor(largestSize_);
}

Problem::Attempt Problem::solve(const Parameters& start, bool withSize) {
  Attempt a;
  a.at = start;
  const bool atInfinity = start(3) == 0;
  const int most = withSize ? std::min(kSizeIterations, options_.maxIterations) : options_.maxIterations;
  for (int round = 0; round < kMaxReweightings && a.iterations < most; ++round) {
    // The weights are held while the light moves: a residual whose own weight moves gains by lights under which the field is
    // steep.
    chooseRule(a.at);
    if (withSize && largestSize_ > kLargestSize) return Attempt{};
    updatePeaks(a.at, true);
    if (lit() == 0) return a;
    relinearise(a.at, round > 0);
    const Parameters before = a.at;
    PeaksFollow follow(*this, a.at);
    ceres::Problem::Options ownership;
    ownership.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    ownership.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    ownership.disable_all_safety_checks = true;
    ownership.evaluation_callback = &follow;
    // The first round may start far off, where every point would be an outlier.
    ceres::HuberLoss loss(round == 0 ? std::max(options_.robustPx, radiusPx_) : options_.robustPx);
    std::deque<RootCost> costs;  // cost functions cannot be moved
    DenseSolution solution;
    {
      ceres::Problem problem(ownership);
      for (const Evidence& e : points_)
        problem.AddResidualBlock(&costs.emplace_back(*this, e), &loss, a.at.data(), a.at.data() + 4, a.at.data() + 5);
      if (atInfinity)
        problem.SetManifold(a.at.data(), new ceres::ProductManifold<ceres::SphereManifold<3>, ceres::SubsetManifold>(
                                             ceres::SphereManifold<3>(), ceres::SubsetManifold(1, {0})));
      else
        problem.SetManifold(a.at.data(), new ceres::SphereManifold<4>());
      if (withSize)
        problem.SetParameterLowerBound(a.at.data() + 5, 0, kLeastRadiusSquared);
      else
        problem.SetParameterBlockConstant(a.at.data() + 5);
      // The frame's maximum is searched again at every step: no unknown settles below the 1e-11 or so to which it is found. The cost: of a sum
      // of squares over hundreds of points, thousandths of a standard deviation.
      solution = solveDense(problem, most - a.iterations, 1e-11, 1e-10);
    }
    a.iterations += solution.iterations;
    if (!solution.usable || !a.at.allFinite()) return a;
    a.converged = solution.converged || solution.cost <= kExactPx * kExactPx * points_.size() ||
                  (a.at - before).norm() < kNearlySettled;
    if (a.converged && (a.at - before).norm() < kSettled) break;
  }
  chooseRule(a.at);
  if (withSize && largestSize_ > kLargestSize) return Attempt{};
  updatePeaks(a.at, true);
  relinearise(a.at, true);
  a.cost = robustCost(a.at);
  a.noisePx = noiseOf(a.at);
  return a;
}

double Problem::gainBySize(const Attempt& a) {
  if (!(a.at(3) > 0)) return 0;  // at infinity a size has no meaning, only an angle
  Parameters grown = a.at;
  const double distance = a.at.head<3>().norm() / a.at(3);
  grown(5) = std::pow(kProbeRadius * std::exp(a.at(4)) * distance, 2);
  chooseRule(grown);
  Eigen::Matrix<double, 4, 3, Eigen::RowMajor> chart;
  ceres::SphereManifold<4>().PlusJacobian(a.at.data(), chart.data());
  Eigen::Matrix<double, Eigen::Dynamic, 5> jacobian(points_.size(), 5);
  Eigen::VectorXd residuals(points_.size());
  const Parameters* const both[] = {&a.at, &grown};
  for (std::size_t i = 0; i < points_.size(); ++i) {
    double value[2], byRoughness = 0;
    Eigen::RowVector4d byLight;
    for (int k = 0; k < 2; ++k) {
      const double* parameters[] = {both[k]->data(), both[k]->data() + 4, both[k]->data() + 5};
      double* blocks[] = {byLight.data(), &byRoughness, nullptr};
      RootCost(*this, points_[i]).Evaluate(parameters, &value[k], k == 0 ? blocks : nullptr);
    }
    jacobian.row(i) << byLight * chart, byRoughness, value[1] - value[0];
    residuals(i) = value[0];
  }
  const Eigen::VectorXd step = jacobian.colPivHouseholderQr().solve(-residuals);
  if (!(step(4) > 0)) return 0;
  return residuals.squaredNorm() - (residuals + jacobian * step).squaredNorm();
}

/// Residuals, and what the Jacobian at the solution makes of their spread.
void Problem::setUncertainty(const Attempt& a, RadianceFit& fit) const {
  const bool atInfinity = a.at(3) == 0;
  const int parameters = 4;
  Eigen::Matrix<double, 4, 3, Eigen::RowMajor> chart;  // ambient from tangent coordinates of L
  ceres::SphereManifold<4>().PlusJacobian(a.at.data(), chart.data());
  Eigen::Matrix<double, Eigen::Dynamic, 4> jacobian(std::max<std::size_t>(points_.size(), 4), 4);
  jacobian.setZero();
  std::vector<double> residuals;
  std::vector<int> views, counts(fit.residualPx.size(), 0);
  double sum = 0;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const Evidence& e = points_[i];
    double residual = 0, byRoughness = 0;
    Eigen::RowVector4d byLight;
    const double* at[] = {a.at.data(), a.at.data() + 4, a.at.data() + 5};
    double* blocks[] = {byLight.data(), &byRoughness, nullptr};
    RootCost(*this, e).Evaluate(at, &residual, blocks);
    jacobian.row(i) << byLight * chart, byRoughness;
    residuals.push_back(residual);
    views.push_back(e.view);
    sum += residual * residual;
    fit.residualPx[e.view] += residual * residual;
    ++counts[e.view];
  }
  for (std::size_t v = 0; v < counts.size(); ++v) fit.residualPx[v] = counts[v] ? std::sqrt(fit.residualPx[v] / counts[v]) : 0;
  fit.rmsPx = std::sqrt(sum / points_.size());
  fit.positionCovariance.setZero();
  fit.positionCovariance.diagonal().setConstant(std::numeric_limits<double>::infinity());
  const Eigen::Matrix4d r = Eigen::HouseholderQR<Eigen::Matrix<double, Eigen::Dynamic, 4>>(jacobian)
                                .matrixQR()
                                .topRows<4>()
                                .triangularView<Eigen::Upper>();
  const Eigen::JacobiSVD<Eigen::Matrix4d> svd(r, Eigen::ComputeFullV);
  if (!(svd.singularValues()(3) > 1e-14 * svd.singularValues()(0))) return;  // a free direction, to round-off
  const ResidualSpread spread = residualSpread(residuals, views, parameters, options_.robustPx);
  const Eigen::Matrix4d root = std::sqrt(spread.factor) * svd.matrixV() * svd.singularValues().cwiseInverse().asDiagonal();
  if (!atInfinity) {
    const double w = a.at(3);
    Eigen::Matrix<double, 3, 4> position;  // d(l / w)
    position << Eigen::Matrix3d::Identity() / w, -a.at.head<3>() / (w * w);
    const Eigen::Matrix<double, 3, 4> half = scale_ * position * chart * root.topRows<3>();
    const Eigen::Matrix3d covariance = half * half.transpose();
    if (covariance.allFinite()) fit.positionCovariance = covariance;
  }
  // In the world, with |L| = 1 again: d(y / |y|) = (I - u u^T) dy / |y|.
  Eigen::Matrix4d toWorld = Eigen::Matrix4d::Identity();
  toWorld.topLeftCorner<3, 3>() *= scale_;
  toWorld.topRightCorner<3, 1>() = origin_;
  const Eigen::Vector4d y = toWorld * a.at.head<4>(), u = y.normalized();
  const Eigen::Matrix4d dy = toWorld * chart * root.topRows<3>();
  ParameterUncertainty uncertainty;
  uncertainty.root.resize(5, 4);
  uncertainty.root.topRows<4>() = (dy - u * (u.transpose() * dy)) / y.norm();
  uncertainty.root.bottomRows<1>() = root.bottomRows<1>();
  uncertainty.noisePx = spread.noisePx;
  uncertainty.degreesOfFreedom = spread.degreesOfFreedom;
  if (uncertainty.root.allFinite()) fit.uncertainty = std::move(uncertainty);
}

RadianceFit Problem::describe(const Attempt& a, std::size_t views) {
  chooseRule(a.at);
  updatePeaks(a.at, true);
  relinearise(a.at, true);
  RadianceFit fit;
  fit.lobe = lobe_;
  fit.roughness = std::exp(a.at(4));
  fit.light = inWorld(a.at.head<4>());
  fit.lightRadius = scale_ * std::sqrt(std::max(0.0, a.at(5)));
  fit.cost = a.cost;
  fit.points = static_cast<int>(points_.size());
  fit.iterations = a.iterations;
  fit.residualPx.assign(views, 0);
  setUncertainty(a, fit);
  return fit;
}

/// L in normalised coordinates, |L| = 1.
Eigen::Vector4d normalisedLight(const Light& light, const ContourEvidence& evidence) {
  Eigen::Vector4d l;
  l << (light.homogeneous().head<3>() - light.homogeneous().w() * evidence.origin) / evidence.scale, light.homogeneous().w();
  require(l.norm() > 0, "fitRadiance: no light");
  return l.normalized();
}

}  // namespace

std::vector<RadianceStart> screenStarts(Lobe lobe, const std::vector<RadianceView>& views, const Light& light, double roughness,
                                        const RadianceFitOptions& options) {
  require(roughness > 0 && std::isfinite(roughness), "screenStarts: roughness must be positive");
  RadianceFitOptions quick = options;
  quick.pointsPerView = std::min(options.pointsPerView, kScreenPoints);
  quick.maxIterations = std::min(options.maxIterations, kScreenIterations);
  Outcome<ContourEvidence> gathered = lobe::gatherEvidence(views, quick.pointsPerView);
  if (!gathered) return {};
  const Eigen::Vector3d direction = normalisedLight(light, *gathered).head<3>().normalized();
  Problem problem(lobe, views, *std::move(gathered), quick);
  std::vector<RadianceStart> starts;
  for (const double distance : {0.5, 1.0, 2.0, 5.0, 0.0})
    for (const double factor : {1.0, 0.5, 2.0}) {
      Eigen::Vector4d from;
      from << (distance > 0 ? Eigen::Vector3d(distance * direction) : direction), (distance > 0 ? 1.0 : 0.0);
      const Problem::Attempt a = problem.solve(from.normalized(), std::min(factor * roughness, 1.0), distance == 0);
      if (!std::isfinite(a.cost) || !a.at.allFinite() || !(a.at(4) < std::log(kWidest))) continue;
      starts.push_back({lobe, problem.inWorld(a.at.head<4>()), std::exp(a.at(4)), a.cost / double(problem.points().size())});
    }
  std::stable_sort(starts.begin(), starts.end(), [](const RadianceStart& a, const RadianceStart& b) { return a.cost < b.cost; });
  return starts;
}

Outcome<RadianceFit> fitRadiance(Lobe lobe, const std::vector<RadianceView>& views, const Light& light, double roughness,
                                 const RadianceFitOptions& options) {
  require(options.pointsPerView >= 3 && options.robustPx > 0 && options.maxIterations >= 1, "fitRadiance: options");
  require(roughness > 0 && std::isfinite(roughness), "fitRadiance: roughness must be positive");
  Outcome<ContourEvidence> gathered = lobe::gatherEvidence(views, options.pointsPerView);
  if (!gathered) return gathered.failure();
  const ContourEvidence frame{{}, {}, gathered->origin, gathered->scale, gathered->radiusPx};
  const Eigen::Vector4d first = normalisedLight(light, frame);
  Problem problem(lobe, views, *std::move(gathered), options);
  const auto good = [&](const Problem::Attempt& a) { return problem.explains(a, kPoorShare); };
  Problem::Attempt best = problem.solve(first, roughness, first.w() == 0);
  int iterations = best.iterations;
  if (!good(best) && options.otherStarts) {
    std::vector<RadianceStart> starts = screenStarts(lobe, views, light, roughness, options);
    if (starts.size() > kPromising) starts.resize(kPromising);
    for (const RadianceStart& from : starts) {
      const Eigen::Vector4d at = normalisedLight(from.light, frame);
      const Problem::Attempt other = problem.solve(at, from.roughness, at.w() == 0);
      iterations += other.iterations;
      if (other.converged != best.converged ? other.converged : other.cost < best.cost) best = other;
      if (good(best)) break;
    }
  }
  if (!std::isfinite(best.cost))
    return problem.lit() == 0 ? Failure{Reason::NoBrightestPoint, "no frame has a lit maximum"}
                              : Failure{Reason::NotConverged, ""};
  if (!best.converged) return Failure{Reason::NotConverged, "after " + std::to_string(iterations) + " iterations"};
  // A size that the contours do not show would only take up noise: it must promise, and then keep, a clear gain.
  if (options.lightSize && good(best) && problem.gainBySize(best) > kLeastGain * best.cost) {
    // The width seen is that of light and lobe together: from a light that is narrower, and from one that is wider than the lobe.
    const Problem::Attempt point = best;
    for (const auto& [radius, width] : {std::pair{1.0, 0.9}, std::pair{1.6, 0.5}}) {
      Parameters start = point.at;
      start(4) += std::log(width);
      start(5) = std::pow(radius * std::exp(point.at(4)) * point.at.head<3>().norm() / point.at(3), 2);
      const Problem::Attempt sized = problem.solve(start, true);
      iterations += sized.iterations;
      if (sized.converged && sized.cost < (1 - kLeastGain) * point.cost && sized.cost < best.cost &&
          sized.at(5) > 2 * kLeastRadiusSquared)
        best = sized;
      if (problem.leavesNoiseOnly(best)) break;
    }
  }
  RadianceFit fit = problem.describe(best, views.size());
  fit.iterations = iterations;
  fit.poor = !good(best);
  fit.doubtful = !problem.explains(best, kDoubtShare);
  return fit;
}

}  // namespace glint
