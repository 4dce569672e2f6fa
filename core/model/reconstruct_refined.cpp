// SPDX-License-Identifier: BSD-3-Clause
#include <ceres/ceres.h>

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <cmath>
#include <limits>

#include "core/model/ellipse_distance.h"
#include "core/model/reconstruct_detail.h"

namespace glint {
namespace {
/// Centre (3) and lower factor L of S = L L^T by columns (00, 10, 20, 11, 21, 22), normalised world.
using Parameters = Eigen::Matrix<double, 9, 1>;

Eigen::Matrix3d factorOf(const double* p) { return Eigen::Matrix3d{{p[3], 0, 0}, {p[4], p[6], 0}, {p[5], p[7], p[8]}}; }

/// Outline of (c, L) in a projection whose pixels are near the origin; nothing when it is no ellipse.
std::optional<Ellipse> outlineOf(const Eigen::Matrix<double, 3, 4>& p, const Eigen::Vector3d& c, const Eigen::Matrix3d& l) {
  const Outcome<Ellipse> e = [&]() -> Outcome<Ellipse> {
    const Eigen::Vector3d h = p.leftCols<3>() * c + p.col(3);
    const Eigen::Matrix3d g = p.leftCols<3>() * l;
    const double reach = g.row(2).norm();
    if (!(h.z() > reach)) return Failure{Reason::NotAnEllipse, ""};
    const double d = (h.z() - reach) * (h.z() + reach);
    const Pixel origin = h.head<2>() / h.z();
    const Eigen::Matrix<double, 2, 3> spread = g.topRows<2>() - origin * g.row(2);
    const Eigen::Vector2d offset = -(spread * g.row(2).transpose()) / d;
    const Eigen::Matrix2d shape = offset * offset.transpose() + spread * spread.transpose() / d;
    DualConic local;
    local.matrix << -shape, Eigen::Vector2d::Zero(), Eigen::RowVector2d::Zero(), 1.0;
    Outcome<Ellipse> ellipse = toEllipse(local);
    if (ellipse) ellipse->centre = origin + offset;
    return ellipse;
  }();
  if (!e) return std::nullopt;
  return *e;
}

/// Signed distances of one view's contour points to the outline, px. By the envelope theorem only the outline's support in the
/// direction of the foot's normal moves the distance: with l = (n, -n.foot) the tangent and pi = P^T l its plane,
/// d(distance) = -d(pi^T Q pi) / (2 e3^T P Q pi).
class OutlineCost : public ceres::CostFunction {
 public:
  OutlineCost(const Eigen::Matrix<double, 3, 4>& projection, std::vector<Pixel> points)
      : projection_(projection), points_(std::move(points)) {
    set_num_residuals(int(points_.size()));
    mutable_parameter_block_sizes()->push_back(9);
  }
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    const Eigen::Vector3d c(parameters[0][0], parameters[0][1], parameters[0][2]);
    const Eigen::Matrix3d l = factorOf(parameters[0]);
    const std::optional<Ellipse> e = outlineOf(projection_, c, l);
    if (!e) return false;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const EllipseFoot foot = footOnEllipse(*e, points_[i]);
      residuals[i] = foot.distance;
      if (!jacobians || !jacobians[0]) continue;
      const Eigen::Vector3d tangent(foot.normal.x(), foot.normal.y(), -foot.normal.dot(foot.point));
      const Eigen::Vector4d plane = projection_.transpose() * tangent;
      const Eigen::Vector3d n = plane.head<3>(), ln = l.transpose() * n;
      const double atCentre = n.dot(c) + plane.w();
      // Q pi = ( (c.n + w) c - S n , c.n + w )
      const double third = projection_.row(2).head<3>().dot(atCentre * c - l * ln) + projection_(2, 3) * atCentre;
      const double k = -1 / third;
      double* row = jacobians[0] + 9 * i;
      for (int j = 0; j < 3; ++j) row[j] = k * atCentre * n(j);
      int column = 3;
      for (int j = 0; j < 3; ++j)
        for (int m = j; m < 3; ++m) row[column++] = -k * n(m) * ln(j);
    }
    return true;
  }

 private:
  Eigen::Matrix<double, 3, 4> projection_;
  std::vector<Pixel> points_;
};

/// U (c - mean) with U^T U the inverse of the covariance.
class PriorCost : public ceres::SizedCostFunction<3, 9> {
 public:
  PriorCost(const Eigen::Matrix3d& whitening, const Eigen::Vector3d& mean) : whitening_(whitening), mean_(mean) {}
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    const Eigen::Vector3d r = whitening_ * (Eigen::Vector3d(parameters[0][0], parameters[0][1], parameters[0][2]) - mean_);
    for (int i = 0; i < 3; ++i) residuals[i] = r(i);
    if (jacobians && jacobians[0])
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 9; ++j) jacobians[0][9 * i + j] = j < 3 ? whitening_(i, j) : 0.0;
    return true;
  }

 private:
  Eigen::Matrix3d whitening_;
  Eigen::Vector3d mean_;
};
}  // namespace

Outcome<Reconstruction> reconstructRefined(const std::vector<ConicView>& views, const Ellipsoid& start,
                                           const std::optional<CentrePrior>& prior, int maxIterations) {
  require(maxIterations >= 1, "reconstructRefined: maxIterations");
  if (const std::optional<Failure> failure = detail::check(views)) return *failure;
  const std::size_t need = prior ? 2 : 3;
  if (views.size() < need)
    return Failure{Reason::TooFewViews, "need " + std::to_string(need) + ", have " + std::to_string(views.size())};
  // The world is measured from the start's centre in units of its size, each image from its own ellipse's centre.
  const Eigen::Vector3d origin = start.centre();
  const double scale = start.semiAxes().norm();
  ceres::Problem problem;
  Parameters p = Parameters::Zero();
  for (const ConicView& v : views) {
    Eigen::Matrix<double, 3, 4> projection = v.projection.matrix;
    projection.topRows<2>() -= v.ellipse.centre * projection.row(2);
    projection.col(3) += projection.leftCols<3>() * origin;
    projection.leftCols<3>() *= scale;
    std::vector<Pixel> points = detail::contourOf(v);
    for (Pixel& q : points) q -= v.ellipse.centre;
    problem.AddResidualBlock(new OutlineCost(projection, std::move(points)), nullptr, p.data());
  }
  if (prior) {
    if (!prior->mean.allFinite() || !prior->covariance.allFinite()) return Failure{Reason::NotFinite, "prior"};
    const Eigen::LLT<Eigen::Matrix3d> llt(prior->covariance / (scale * scale));
    require(llt.info() == Eigen::Success, "reconstructRefined: the prior's covariance is not positive definite");
    const Eigen::Matrix3d whitening = llt.matrixL().solve(Eigen::Matrix3d::Identity());
    problem.AddResidualBlock(new PriorCost(whitening, (prior->mean - origin) / scale), nullptr, p.data());
  }

  const auto parametersOf = [&](const Eigen::Vector3d& axes) {
    // S = (D R^T)^T (D R^T); the triangular factor of D R^T is L^T, also for a flat ellipsoid.
    const Eigen::Matrix3d root = axes.asDiagonal() * start.worldFromBody().linear().transpose();
    const Eigen::Matrix3d upper = Eigen::HouseholderQR<Eigen::Matrix3d>(root).matrixQR().triangularView<Eigen::Upper>();
    Parameters q = Parameters::Zero();
    q << 0, 0, 0, upper(0, 0), upper(0, 1), upper(0, 2), upper(1, 1), upper(1, 2), upper(2, 2);
    return q;
  };
  const Parameters exact = parametersOf(start.semiAxes() / scale);
  const auto cost = [&](const Parameters& at) {
    p = at;
    double value = 0;
    return problem.Evaluate(ceres::Problem::EvaluateOptions(), &value, nullptr, nullptr, nullptr) && std::isfinite(value)
               ? value
               : std::numeric_limits<double>::infinity();
  };
  const double startCost = cost(exact);
  if (!std::isfinite(startCost)) return Failure{Reason::NotAnEllipsoid, "the start has no elliptic outline in one of the views"};

  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.logging_type = ceres::SILENT;
  options.num_threads = 1;
  options.max_num_iterations = maxIterations;
  options.function_tolerance = 1e-12;
  options.parameter_tolerance = 1e-12;
  options.gradient_tolerance = 1e-14;
  ceres::Solver::Summary summary;
  const auto run = [&](const Parameters& from) {
    p = from;
    ceres::Solve(options, &problem, &summary);
    return summary.IsSolutionUsable() && p.allFinite() ? summary.final_cost : std::numeric_limits<double>::infinity();
  };
  // A zero axis is a stationary point by symmetry: leave it with a small one, and come back if that did not help.
  const Eigen::Vector3d axes = start.semiAxes() / scale, inflated = axes.cwiseMax(0.02 * axes.x());
  double finalCost = std::numeric_limits<double>::infinity();
  if (axes != inflated && std::isfinite(cost(parametersOf(inflated)))) finalCost = run(parametersOf(inflated));
  int iterations = std::isfinite(finalCost) ? int(summary.iterations.size()) - 1 : 0;
  Parameters best = p;
  bool converged = std::isfinite(finalCost) && summary.termination_type == ceres::CONVERGENCE;
  if (!(finalCost <= startCost)) {
    finalCost = run(exact);
    iterations += int(summary.iterations.size()) - 1;
    best = p;
    converged = summary.termination_type == ceres::CONVERGENCE;
    if (!(finalCost <= startCost)) {
      best = exact;
      converged = converged || summary.termination_type == ceres::FAILURE;
    }
  }
  if (!converged && !summary.iterations.empty()) {
    // An axis that shrinks to zero does so ever more slowly: out of iterations there is as good as converged when the last fifth
    // of the way gained less than a hundredth.
    const std::size_t n = summary.iterations.size();
    const double before = summary.iterations[n - 1 - n / 5].cost;
    converged = before - finalCost <= 0.01 * before;
  }

  const Eigen::Matrix3d l = factorOf(best.data());
  const Outcome<Ellipsoid> local = Ellipsoid::fromCentreAndShape(best.head<3>(), l * l.transpose());
  if (!local) return Failure{Reason::NotAnEllipsoid, "the refined shape has two empty axes"};
  Eigen::Isometry3d pose = local->worldFromBody();
  pose.translation() = origin + scale * pose.translation();
  Reconstruction result;
  result.solver = converged ? "refined" : "refined, stopped at the iteration limit";
  result.iterations = iterations;
  result.ellipsoid = Ellipsoid(pose, scale * local->semiAxes());
  result.quadric = result.ellipsoid->dual();
  result.residualPx = detail::residuals(views, result);
  return result;
}

}  // namespace glint
