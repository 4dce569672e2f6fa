// SPDX-License-Identifier: BSD-3-Clause
#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>

#include "core/light/bundle_attempt.h"
#include "core/light/dense_solver.h"
#include "core/light/robust_costs.h"

namespace glint::bundling {
namespace {

/// Beyond twenty times the distance of the cameras a light may as well be at infinity.
constexpr double kFar = 0.05;

/// Residual with an extent, over the light (4), the limit angle (1) and the extent (6) in units of `unit`: about the squared
/// distance of the light, so that the six numbers are squared angles whatever the distance.
class DirectedCost final : public ceres::SizedCostFunction<1, 4, 1, 6> {
 public:
  DirectedCost(const ContourEvidence& evidence, double unit) : evidence_(evidence), unit_(unit) {}
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    const Eigen::Vector4d light = Eigen::Map<const Eigen::Vector4d>(parameters[0]);
    const Vector6 extent = unit_ * Eigen::Map<const Vector6>(parameters[2]);
    Eigen::Matrix<double, 1, 11> row;
    if (!directedResidual(evidence_, light, *parameters[1], extent, *residuals, jacobians ? &row : nullptr)) return false;
    if (!jacobians) return true;
    if (jacobians[0]) Eigen::Map<Eigen::RowVector4d>{jacobians[0]} = row.head<4>();
    if (jacobians[1]) *jacobians[1] = row(4);
    if (jacobians[2]) Eigen::Map<Eigen::Matrix<double, 1, 6>>{jacobians[2]} = unit_ * row.tail<6>();
    return true;
  }

 private:
  const ContourEvidence& evidence_;
  double unit_;
};

struct ExtentPrior {
  double weight;
  template <class T>
  bool operator()(const T* extent, T* out) const {
    for (int i = 0; i < 6; ++i) out[i] = T(weight * (i < 3 ? 1.0 : 1.4142135623730951)) * extent[i];
    return true;
  }
};

double meanDistance(const Eigen::Vector4d& light, const std::vector<ContourEvidence>& points) {
  double reach = 0;
  for (const ContourEvidence& e : points)
    reach += (light.w() > 0 ? (light.head<3>() / light.w() - e.at.position).norm() : 1.0) / double(points.size());
  return reach;
}

/// Solves from `start` in its own chart: a light at infinity stays there. `directed` is false where nothing was found in front of
/// the surface.
/// @param noisePx  of the points, the unit in which they and the prior are compared
Attempt inChartOf(std::vector<ContourEvidence>& points, const Attempt& start, double noisePx, double robustPx,
                  int maxIterations) {
  Attempt a = start, none = start;
  restoreBiases(points, start);
  a.directed = true;
  none.directed = false;
  const bool atInfinity = a.light.w() == 0;
  const double prior = extentPrior(start, points), unit = std::pow(meanDistance(start.light, points), 2);
  for (int round = 0; round < kMaxReweightings; ++round) {
    renew(points, a, 0);
    const Attempt before = a;
    Vector6 extent = a.extent / unit;
    RobustCosts<ceres::CostFunction, DirectedCost> costs(points, robustPx, unit);
    ceres::AutoDiffCostFunction<ExtentPrior, 6, 6> reluctance(new ExtentPrior{noisePx * prior * unit});
    ceres::Problem::Options options;
    options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    options.disable_all_safety_checks = true;
    ceres::Problem problem(options);
    problem.AddResidualBlock(&costs, nullptr, a.light.data(), &a.limit, extent.data());
    problem.AddResidualBlock(&reluctance, nullptr, extent.data());
    if (atInfinity)
      problem.SetManifold(a.light.data(), new ceres::ProductManifold<ceres::SphereManifold<3>, ceres::SubsetManifold>(
                                              ceres::SphereManifold<3>(), ceres::SubsetManifold(1, {0})));
    else
      problem.SetManifold(a.light.data(), new ceres::SphereManifold<4>());
    const DenseSolution solution = solveDense(problem, maxIterations, 1e-12);  // to round-off, as without an extent
    a.iterations += solution.iterations;
    a.extent = unit * extent;
    if (!solution.usable || !a.light.allFinite() || !a.extent.allFinite() || !(a.limit > 0)) return none;
    const double moved =
        std::max({(a.light - before.light).norm(), std::abs(a.limit - before.limit), (a.extent - before.extent).norm() * prior});
    if (moved < 1e-9) break;  // as without an extent
  }
  settleSide(points, a);
  if (a.behind) return none;
  renew(points, a, 0);
  keepBiases(points, a);
  a.cost = robustCost(points, a, robustPx);
  return a;
}

/// The noise is estimated from the residuals of the start, which contain what the extent explains, then from those of each
/// result, until it settles.
Attempt weighed(std::vector<ContourEvidence>& points, const Attempt& start, double robustPx, int maxIterations) {
  constexpr double kLeastNoisePx =
      0.01;                            // below the accuracy of any detection; keeps the prior's weight above zero on exact data
  constexpr double kSameNoise = 0.01;  // residuals tell a standard deviation to some hundredths
  constexpr int kMostWeightings = 6;
  constexpr int kConstant = 4, kWithExtent = 10;  // parameters
  const auto noisePx = [&](const Attempt& a) {
    return std::max(kLeastNoisePx, std::sqrt(spreadOf(points, a, a.directed ? kWithExtent : kConstant, robustPx).factor));
  };
  double counted = noisePx(start);
  Attempt found = inChartOf(points, start, counted, robustPx, maxIterations);
  for (int round = 0; round < kMostWeightings && found.directed; ++round) {
    const double noise = noisePx(found);
    if (std::abs(noise / counted - 1) < kSameNoise) break;
    const Attempt again = inChartOf(points, found, noise, robustPx, maxIterations);
    if (!again.directed) break;
    found = again;
    counted = noise;
  }
  return found;
}

}  // namespace

bool directedResidual(const ContourEvidence& e, const Eigen::Vector4d& light, double constant, const Vector6& entries,
                      double& residual, Eigen::Matrix<double, 1, 11>* derivatives) {
  if (!(constant > 0)) return false;
  const EvidencePoint& s = e.at;
  const double k = e.pixelsPerRadian;
  const Eigen::Matrix3d extent = symmetric(entries);
  if (!derivatives) {
    residual = k * (angle(s, light) - directedLimit(constant, extent, s.position, s.normal, s.toCamera, light)) - e.biasPx;
    return std::isfinite(residual);
  }
  const DirectedLimit limit = directedLimitWithDerivatives(constant, extent, s.position, s.normal, s.toCamera, light);
  residual = k * (angle(s, light) - limit.angle) - e.biasPx;
  derivatives->head<4>() = k * (incidentAngleByLight(s.position, s.normal, s.toCamera, light) - limit.byLight).transpose();
  (*derivatives)(4) = -k * limit.byLimit;
  derivatives->tail<6>() = -k * limit.byExtent.transpose();
  return std::isfinite(residual);
}

double extentPrior(const Attempt& a, const std::vector<ContourEvidence>& points) {
  // Width of the light that is seen under the limit angle: H turns half as much as L.
  const double width = 2 * meanDistance(a.light, points) * a.limit;
  // A compromise, measured on docs/accuracy.md and docs/reflectance.md. With a larger value, fits to few views of a plane drift
  // along what their contours hardly show (plane_to_cylinder per surface: 0.093 % at 0.4, 0.084 % at 0.3); with a smaller one, a
  // light wider than the lobe is held back (1.20 % at 0.1, 0.31 % at 0.3).
  constexpr double kShare = 0.3;
  return 1 / (kShare * width * width);
}

Attempt directed(std::vector<ContourEvidence>& points, const Attempt& start, double robustPx, int maxIterations) {
  Attempt best = weighed(points, start, robustPx, maxIterations);
  if (start.light.w() > 0 && (!best.directed || best.light.w() < kFar)) {
    Attempt far = best.directed ? best : start;
    far.light.w() = 0;
    far.light.normalize();
    far.extent.setZero();
    settleSide(points, far);
    if (!far.behind) far = weighed(points, far, robustPx, maxIterations);
    // The simpler light is taken where it is as good but for round-off.
    if (far.directed && (!best.directed || far.cost <= best.cost * (1 + 1e-9) + 1e-18 * double(points.size()))) best = far;
  }
  restoreBiases(points, best);
  renew(points, best, best.directed ? 0 : best.noiseShare);
  return best;
}

}  // namespace glint::bundling
