// SPDX-License-Identifier: BSD-3-Clause
#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <map>

#include "core/base/dense_algebra.h"
#include "core/base/number_text.h"
#include "core/base/numeric.h"
#include "core/base/progress.h"
#include "core/base/residual_spread.h"
#include "core/base/solver_trace.h"
#include "core/light/bundle_attempt.h"
#include "core/light/dense_solver.h"
#include "core/light/estimate.h"
#include "core/light/left_out.h"
#include "core/light/robust_costs.h"

namespace glint {
namespace {
using namespace bundling;
/// Share of the contours' radius, to first order. A smaller limit angle says that every contour point mirrors the light.
constexpr double kLeastLimitShare = 0.01;
/// Share of the residuals' variance. Below it, moving weights would change nothing that can be seen.
constexpr double kLeastNoiseShare = 0.1;

/// (alpha - alpha_lim) in pixels, with d alpha / d L in closed form. The light is (l, w), or l alone where it is held at
/// infinity.
class AngleCost final : public ceres::CostFunction {
 public:
  /// @param noiseShare  s, see noiseShare(): the weight is k (|d alpha / d pixel| k)^-s of the light, k the held one
  AngleCost(const ContourEvidence& evidence, bool atInfinity, double noiseShare = 0)
      : evidence_(evidence),
        size_(atInfinity ? 3 : 4),
        share_(evidence.left && evidence.right && evidence.up && evidence.down ? noiseShare : 0) {
    set_num_residuals(1);
    mutable_parameter_block_sizes()->push_back(size_);
    mutable_parameter_block_sizes()->push_back(1);
  }
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    const EvidencePoint& s = evidence_.at;
    Eigen::Vector4d light(parameters[0][0], parameters[0][1], parameters[0][2], size_ == 4 ? parameters[0][3] : 0.0);
    const Eigen::Vector3d plain = light.head<3>() - light.w() * s.position;
    const double sign = s.normal.dot(plain) < 0 ? -1 : 1, distance = plain.norm();
    if (!(distance > 0)) return false;
    const Eigen::Vector3d toLight = sign * plain / distance, half = toLight + s.toCamera;
    const double length = half.norm();
    if (!(length > 0)) return false;
    const Eigen::Vector3d h = half / length;
    const double sine = s.normal.cross(h).norm(), cosine = s.normal.dot(h), off = std::atan2(sine, cosine) - parameters[1][0];
    double k = evidence_.pixelsPerRadian;
    Eigen::Vector2d slope(0, 0);
    if (share_ > 0) {
      slope << angle(*evidence_.right, light) - angle(*evidence_.left, light),
          angle(*evidence_.down, light) - angle(*evidence_.up, light);
      slope /= 2 * ContourEvidence::kStepPx;
      if (!(slope.norm() > 0)) return false;
      k *= std::pow(slope.norm() * k, -share_);
    }
    residuals[0] = k * off - evidence_.biasPx;
    if (!jacobians) return true;
    if (jacobians[0]) {
      const auto at = [&](const EvidencePoint& seen) {
        return incidentAngleByLight(seen.position, seen.normal, seen.toCamera, light);
      };
      Eigen::Vector4d byLight = k * at(s);
      if (share_ > 0)
        byLight -=
            off * share_ * k / slope.squaredNorm() / (2 * ContourEvidence::kStepPx) *
            (slope.x() * (at(*evidence_.right) - at(*evidence_.left)) + slope.y() * (at(*evidence_.down) - at(*evidence_.up)));
      for (int i = 0; i < size_; ++i) jacobians[0][i] = byLight(i);
    }
    if (jacobians[1]) jacobians[1][0] = -k;
    return true;
  }

 private:
  const ContourEvidence& evidence_;
  int size_;
  double share_;
};

ceres::Problem::Options borrowedCosts() {
  ceres::Problem::Options options;
  options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.disable_all_safety_checks = true;
  return options;
}

/// Solves with weights that are renewed until nothing moves. False when the solution is not usable.
bool reweighted(std::vector<ContourEvidence>& points, Attempt& a, bool atInfinity, double share, const BundleOptions& options) {
  const int already = a.iterations;
  a.noiseShare = share;
  for (int round = 0; round < kMaxReweightings && a.iterations < already + options.maxIterations; ++round) {
    // The weights are held while the light moves (but for the share that is noise). A residual whose own weight moves with the
    // light prefers lights under which the angle changes faster over the image. Held weights give no such reward, and the fixed
    // point is reached in a few rounds.
    if (round > 0 || share > 0)
      renew(points, a, share);
    else
      reweight(points, a.light);
    RobustCosts<ceres::CostFunction, AngleCost> costs(points, options.robustPx, atInfinity, share);
    const Eigen::Vector4d before = a.light;
    const double limitBefore = a.limit;
    DenseSolution solution;
    {
      ceres::Problem problem(borrowedCosts());
      problem.AddResidualBlock(&costs, nullptr, a.light.data(), &a.limit);
      if (atInfinity)
        problem.SetManifold(a.light.data(), new ceres::SphereManifold<3>());
      else
        problem.SetManifold(a.light.data(), new ceres::SphereManifold<4>());
      if (options.holdLight) problem.SetParameterBlockConstant(a.light.data());
      // Down to round-off: only then do invariances hold to 1e-9.
      solution = solveDense(problem, already + options.maxIterations - a.iterations, 1e-12);
    }
    a.iterations += solution.iterations;
    if (!solution.usable || !a.light.allFinite() || !std::isfinite(a.limit)) return false;
    constexpr double kExact = 1e-20;  // px^2 a point: round-off of a fit that is exact
    a.converged = solution.converged || solution.cost <= kExact * double(points.size());
    const double moved = std::max((a.light - before).norm(), std::abs(a.limit - limitBefore));
    if (a.converged && moved < 1e-9) break;  // unit vector and rad: below what any contour tells
  }
  return true;
}

Attempt solve(std::vector<ContourEvidence>& points, Eigen::Vector4d start, bool atInfinity, const BundleOptions& options) {
  Attempt a;
  for (ContourEvidence& e : points) e.biasPx = 0;
  if (atInfinity) start.w() = 0;
  a.light = start.normalized();
  std::vector<double> angles;
  for (const ContourEvidence& e : points) angles.push_back(angle(e.at, a.light));
  a.limit = upperMedian(angles);
  if (!std::isfinite(a.limit)) return a;
  if (!reweighted(points, a, atInfinity, 0, options)) return a;
  keepBiases(points, a);
  if (const double share = noiseShare(points, a); a.converged && share >= kLeastNoiseShare) {
    Attempt moved = a;
    if (reweighted(points, moved, atInfinity, share, options) && moved.converged) {
      a = moved;
      keepBiases(points, a);
    } else {
      restoreBiases(points, a);
    }
  }
  reweight(points, a.light);
  settleSide(points, a);
  a.cost = robustCost(points, a, options.robustPx);
  return a;
}

/// Carries a solution from (x - origin) / scale to the world.
Eigen::Vector4d worldOf(const Eigen::Vector4d& light, const NormalisedContours& in) {
  Eigen::Vector4d world;
  world << in.scale * light.head<3>() + light.w() * in.origin, light.w();
  return world;
}

/// solve(), recorded in the trace.
Attempt traced(NormalisedContours& contours, Eigen::Vector4d start, bool atInfinity, const BundleOptions& options) {
  if (atInfinity) start.w() = 0;
  TracedRun run(atInfinity ? "light at infinity with one limit angle" : "light with one limit angle", worldOf(start, contours));
  Attempt a = solve(contours.points, start, atInfinity, options);
  const char* const ending = !std::isfinite(a.cost) ? "no usable step"
                             : a.behind             ? "the light lies behind the surface"
                             : a.converged          ? "at a minimum"
                                                    : "out of iterations";
  run.end(a.converged && !a.behind, ending, worldOf(a.light, contours));
  a.run = run.index();
  return a;
}

/// The limit angle's alone, under a light that is known.
void setLimitUncertainty(const std::vector<ContourEvidence>& points, const Attempt& a, double robustPx, Bundle& bundle) {
  const ResidualSpread spread = spreadOf(points, a, 1, robustPx);
  double squares = 0;
  for (const ContourEvidence& e : points) squares += e.pixelsPerRadian * e.pixelsPerRadian;
  bundle.covariance.setZero();
  bundle.positionCovariance.setZero();
  if (!(squares > 0)) return;
  bundle.covariance(3, 3) = spread.factor / squares;
  Eigen::MatrixXd root = Eigen::MatrixXd::Zero(5, 1);
  root(4, 0) = std::sqrt(bundle.covariance(3, 3));
  bundle.uncertainty = ParameterUncertainty{std::move(root), spread.noisePx, spread.degreesOfFreedom};
}

void setCovariance(const std::vector<ContourEvidence>& points, const Attempt& a, const Eigen::Vector3d& origin, double scale,
                   double robustPx, Bundle& bundle) {
  const double infinity = std::numeric_limits<double>::infinity();
  const bool atInfinity = a.light.w() == 0;
  Eigen::Matrix<double, 4, 3, Eigen::RowMajor> chart;  // ambient from tangent coordinates of L
  ceres::SphereManifold<4>().PlusJacobian(a.light.data(), chart.data());
  const Eigen::Index parameters = a.directed ? 10 : 4;
  Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(std::max<Eigen::Index>(points.size() + 6, parameters), parameters);
  for (std::size_t i = 0; i < points.size() && a.directed; ++i) {
    Eigen::Matrix<double, 1, 11> row;
    double value;
    if (!directedResidual(points[i], a.light, a.limit, a.extent, value, &row)) continue;
    jacobian.row(i) << row.head<4>() * chart, row.tail<7>();
  }
  const ResidualSpread spread = spreadOf(points, a, int(parameters), robustPx);
  if (a.directed)  // its prior, in units of the noise, as in the fit
    for (int i = 0; i < 6; ++i)
      jacobian(points.size() + i, 4 + i) = std::sqrt(spread.factor) * extentPrior(a, points) * (i < 3 ? 1 : std::sqrt(2.0));
  for (std::size_t i = 0; i < points.size() && !a.directed; ++i) {
    const AngleCost cost(points[i], false);
    Eigen::RowVector4d byLight;
    double residual, byLimit;
    const double* parameters[] = {a.light.data(), &a.limit};
    double* blocks[] = {byLight.data(), &byLimit};
    if (!cost.Evaluate(parameters, &residual, blocks)) continue;
    jacobian.row(i) << byLight * chart, byLimit;
  }
  const Eigen::MatrixXd r = triangularFactor(jacobian);
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(r, Eigen::ComputeFullV);
  bundle.positionCovariance = infinity * Eigen::Matrix3d::Identity();
  if (!(svd.singularValues()(parameters - 1) > 1e-14 * svd.singularValues()(0))) {  // a free direction, to round-off
    bundle.covariance = Eigen::Matrix4d::Zero();
    bundle.covariance.diagonal().setConstant(infinity);
  } else {
    const Eigen::MatrixXd root = std::sqrt(spread.factor) * svd.matrixV() * svd.singularValues().cwiseInverse().asDiagonal();
    bundle.covariance = root.topRows<4>() * root.topRows<4>().transpose();
    if (!atInfinity) {
      const double w = a.light.w();
      Eigen::Matrix<double, 3, 4> position;  // d(l / w)
      position << Eigen::Matrix3d::Identity() / w, -a.light.head<3>() / (w * w);
      const Eigen::MatrixXd half = scale * position * chart * root.topRows<3>();
      const Eigen::Matrix3d covariance = half * half.transpose();
      if (covariance.allFinite()) bundle.positionCovariance = covariance;
    }
    // In the world, with |L| = 1 again.
    Eigen::Matrix4d toWorld = Eigen::Matrix4d::Identity();
    toWorld.topLeftCorner<3, 3>() *= scale;
    toWorld.topRightCorner<3, 1>() = origin;
    const Eigen::Vector4d y = toWorld * a.light;
    const Eigen::MatrixXd dy = toWorld * chart * root.topRows<3>();
    Eigen::MatrixXd others = root.bottomRows(parameters - 3);
    if (a.directed && !atInfinity) others.bottomRows<6>() *= scale * scale;
    if (auto known = uncertaintyOfUnit(y, dy, others, spread.noisePx, spread.degreesOfFreedom))
      bundle.uncertainty = std::move(known);
  }
  if (!bundle.positionCovariance.allFinite()) {  // inf * 0 left NaN beside the diagonal
    bundle.positionCovariance.setZero();
    bundle.positionCovariance.diagonal().setConstant(infinity);
  }
}

/// The light with one limit angle that explains the points best, from several starts where the first one converges badly.
/// Afterwards the points hold its weights.
struct Best {
  Attempt attempt;
  int iterations = 0;  ///< of all starts
};
/// The limit angle that explains the points best under the start itself.
Outcome<Best> heldAttempt(NormalisedContours& contours, const Eigen::Vector4d& start, const BundleOptions& options) {
  const Attempt a = traced(contours, start, start.w() == 0, options);
  if (a.behind || a.light.head<3>().dot(start.head<3>()) < 0)
    return Failure{Reason::LightBehindSurface, "the known light is behind the surface that shows its highlight"};
  if (!std::isfinite(a.cost) || !a.converged) return Failure{Reason::NotConverged, "limit angle under a known light"};
  traceAnswer(a.run);
  return Best{a, a.iterations};
}
Outcome<Best> bestAttempt(NormalisedContours& contours, const Light& start, const BundleOptions& options) {
  std::vector<ContourEvidence>& points = contours.points;
  Eigen::Vector4d first;
  first << (start.homogeneous().head<3>() - start.homogeneous().w() * contours.origin) / contours.scale, start.homogeneous().w();
  if (!(first.norm() > 0) || !first.allFinite()) first << 0, 0, 1, 0;
  if (options.holdLight) return heldAttempt(contours, first, options);
  const auto attempt = [&](const Eigen::Vector4d& from) {
    Attempt a = traced(contours, from, from.w() == 0, options);
    if (from.w() == 0 && std::isfinite(a.cost) && !a.behind) {  // the light may be nearer than infinity
      const Attempt free = traced(contours, (a.light + Eigen::Vector4d(0, 0, 0, 1e-3)).normalized(), false, options);
      if (!free.behind && free.converged && free.cost < a.cost) a = free;
    } else if (a.behind || a.light.w() < 1e-6) {  // a million scene sizes away: perhaps at infinity
      // Beyond infinity (the rays towards it converge behind the scene), or nearly there: try infinity itself.
      Eigen::Vector4d direction = a.light;
      if (a.behind) direction = -direction;
      const Attempt far = traced(contours, direction, true, options);
      // The simpler light is taken where it is as good but for round-off.
      if (!far.behind && (a.behind || far.cost <= a.cost * (1 + 1e-9) + 1e-18 * points.size())) a = far;
    }
    return a;
  };
  const auto better = [](const Attempt& a, const Attempt& b) {
    return a.behind != b.behind ? b.behind : a.converged != b.converged ? a.converged : a.cost < b.cost;
  };
  const auto good = [&](const Attempt& a) {
    return a.converged && !a.behind && a.cost <= 2 * options.robustPx * options.robustPx * points.size();
  };
  Attempt best = attempt(first);
  int iterations = best.iterations;
  if (!good(best)) {
    // Other starts: the contours' middle reflected, at several distances and at infinity.
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const ContourEvidence& e : points) mean += reflect(e.at.toCamera, e.at.normal);
    if (mean.norm() > 1e-9 * points.size()) {  // directions that cancel have no mean
      mean.normalize();
      for (const double distance : {0.3, 1.0, 3.0, 10.0, 0.0}) {
        Eigen::Vector4d from;
        from << (distance > 0 ? Eigen::Vector3d(distance * mean) : mean), (distance > 0 ? 1.0 : 0.0);
        const Attempt other = attempt(from);
        iterations += other.iterations;
        if (better(other, best)) best = other;
      }
    }
  }
  if (best.behind) return Failure{Reason::LightBehindSurface, "every light that explains the contours is behind the surface"};
  if (!std::isfinite(best.cost) || !best.converged) return Failure{Reason::NotConverged, "light bundle"};

  traceAnswer(best.run);
  // The evidence still holds weights and biases of the last attempt, which need not be the best one.
  restoreBiases(points, best);
  renew(points, best, best.noiseShare);
  keepBiases(points, best);
  return Best{best, iterations};
}

/// directed(), recorded in the trace.
Attempt directedAndTraced(NormalisedContours& contours, const Attempt& start, const BundleOptions& options) {
  TracedRun run("light with its extent", worldOf(start.light, contours));
  const Attempt a = directed(contours.points, start, options.robustPx, options.maxIterations);
  run.end(a.directed, a.directed ? "at a minimum" : "no extent in front of the surface explains the contours better",
          worldOf(a.light, contours));
  if (a.directed) traceAnswer(run.index());
  return a;
}

/// Why a limit angle means nothing: every contour point sees the light in its mirror direction, so any light near it would do.
std::optional<Failure> withoutLimit(const std::vector<ContourEvidence>& points, const Attempt& a) {
  std::map<int, std::pair<Pixel, int>> middles;
  for (const ContourEvidence& e : points) {
    auto& [sum, n] = middles.try_emplace(e.view, Pixel(0, 0), 0).first->second;
    sum += e.pixel;
    ++n;
  }
  std::vector<double> radii, limits;
  for (const ContourEvidence& e : points) {
    const auto& [sum, n] = middles.at(e.view);
    radii.push_back((e.pixel - sum / n).norm());
    limits.push_back(a.limit * e.pixelsPerRadian);
  }
  if (a.limit > 0 && upperMedian(limits) > kLeastLimitShare * upperMedian(radii)) return std::nullopt;
  const std::string detail = formatted(
      "the limit angle comes out at %.2g deg: every contour point mirrors the light, so the contours do not determine it",
      a.limit * 180 / M_PI);
  return Failure{Reason::NotConverged, detail};
}

/// Distances of every view's points from the level set of an attempt, px.
std::vector<std::vector<double>> residualsOfViews(const std::vector<ContourEvidence>& points, const Attempt& a,
                                                  std::size_t views) {
  std::vector<std::vector<double>> residuals(views);
  for (const ContourEvidence& e : points) residuals[std::size_t(e.view)].push_back(residual(e, a));
  return residuals;
}

/// RMS of the distances of points from the level set of an attempt that was found in other coordinates, px.
double rmsElsewhere(const Attempt& found, const NormalisedContours& foundIn, NormalisedContours seen) {
  Attempt a = found;
  const double step = foundIn.scale / seen.scale;
  a.light.head<3>() = step * found.light.head<3>() + found.light.w() * (foundIn.origin - seen.origin) / seen.scale;
  a.light.normalize();
  if (a.light.w() != 0) a.extent *= step * step;  // at infinity it is an angle
  reweight(seen.points, a.light);
  double sum = 0;
  for (const ContourEvidence& e : seen.points) sum += std::pow(residual(e, a), 2);
  return std::sqrt(sum / double(seen.points.size()));
}
}  // namespace

Outcome<Bundle> bundleLight(const std::vector<BundleView>& views, const Light& start, const BundleOptions& options) {
  require(options.pointsPerView >= 3 && options.robustPx > 0 && options.maxIterations >= 1, "bundleLight: options");
  const Outcome<std::vector<ContourEvidence>> evidence = contoursOnSurfaces(views, options.pointsPerView);
  return evidence ? bundleLight(*evidence, views.size(), start, options) : Outcome<Bundle>(evidence.failure());
}

Outcome<Bundle> bundleLight(const std::vector<ContourEvidence>& evidence, std::size_t views, const Light& start,
                            const BundleOptions& options) {
  require(options.robustPx > 0 && options.maxIterations >= 1, "bundleLight: options");
  Outcome<NormalisedContours> contours = normalised(evidence);
  if (!contours) return contours.failure();
  const Outcome<Best> found = bestAttempt(*contours, start, options);
  if (!found) return found.failure();
  const std::vector<ContourEvidence>& points = contours->points;
  const Attempt best = options.limitOrders > 0 ? directedAndTraced(*contours, found->attempt, options) : found->attempt;
  if (const std::optional<Failure> degenerate = withoutLimit(points, best)) return *degenerate;
  Bundle bundle;
  bundle.light = options.holdLight ? start : Light::homogeneous(worldOf(best.light, *contours));
  bundle.limitAngle = best.limit;
  if (best.directed) bundle.extent = symmetric(best.extent) * (best.light.w() == 0 ? 1.0 : contours->scale * contours->scale);
  bundle.iterations = found->iterations;
  double sum = 0;
  for (const std::vector<double>& residuals : residualsOfViews(points, best, views)) {
    double ofView = 0;
    for (const double r : residuals) ofView += r * r;
    sum += ofView;
    bundle.residualPx.push_back(residuals.empty() ? 0.0 : std::sqrt(ofView / double(residuals.size())));
    bundle.typicalPx.push_back(rmsWithoutTail(residuals));
  }
  bundle.rmsPx = std::sqrt(sum / points.size());
  if (options.holdLight)
    setLimitUncertainty(points, best, options.robustPx, bundle);
  else
    setCovariance(points, best, contours->origin, contours->scale, options.robustPx, bundle);
  return bundle;
}

Outcome<LeftOutErrors> leftOutErrors(const std::vector<BundleView>& views, const Light& start, const BundleOptions& options,
                                     int atMost) {
  const Outcome<std::vector<ContourEvidence>> evidence = contoursOnSurfaces(views, options.pointsPerView);
  return evidence ? leftOutErrors(*evidence, placesOf(views), start, options, atMost)
                  : Outcome<LeftOutErrors>(evidence.failure());
}

Outcome<LeftOutErrors> leftOutErrors(const std::vector<ContourEvidence>& evidence, const std::vector<int>& places,
                                     const Light& start, const BundleOptions& options, int atMost) {
  require(atMost >= 1, "leftOutErrors: atMost");
  const std::vector<int> leave = placesToLeaveOut(places, atMost);
  const int folds = int(leave.size());
  LeftOutErrors errors{std::vector<double>(std::size_t(folds)), std::vector<double>(std::size_t(folds))};
  std::vector<std::optional<Failure>> failures(static_cast<std::size_t>(folds));
  const auto fold = [&](int k) {
    std::vector<ContourEvidence> others, own;
    for (const ContourEvidence& e : evidence) (places[std::size_t(e.view)] == leave[std::size_t(k)] ? own : others).push_back(e);
    Outcome<NormalisedContours> contours = normalised(std::move(others));
    const Outcome<NormalisedContours> seen = normalised(std::move(own));
    const Outcome<Best> best = contours ? bestAttempt(*contours, start, options) : Outcome<Best>(contours.failure());
    if (!best) {
      failures[std::size_t(k)] = best.failure();
      return;
    }
    errors.constant[std::size_t(k)] = seen ? rmsElsewhere(best->attempt, *contours, *seen) : std::nan("");
    const Attempt wide = directed(contours->points, best->attempt, options.robustPx, options.maxIterations);
    errors.directed[std::size_t(k)] = seen ? rmsElsewhere(wide, *contours, *seen) : std::nan("");
  };
  parallelFor(folds, fold, {}, "light");
  for (const std::optional<Failure>& failure : failures)
    if (failure) return *failure;
  return errors;
}

std::vector<double> typicalResidualsPx(const std::vector<ContourEvidence>& evidence, std::size_t views, const Light& light,
                                       double limitAngle) {
  const Outcome<NormalisedContours> contours = normalised(evidence);
  if (!contours) return std::vector<double>(views, std::nan(""));
  std::vector<ContourEvidence> points = contours->points;
  Attempt a;
  a.light << (light.homogeneous().head<3>() - light.homogeneous().w() * contours->origin) / contours->scale,
      light.homogeneous().w();
  a.light.normalize();
  a.limit = limitAngle;
  reweight(points, a.light);
  std::vector<double> typical;
  for (const std::vector<double>& residuals : residualsOfViews(points, a, views))
    typical.push_back(residuals.empty() ? std::nan("") : rmsWithoutTail(residuals));
  return typical;
}

}  // namespace glint
