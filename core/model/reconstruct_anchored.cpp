// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>

#include "core/base/dense_algebra.h"
#include "core/model/reconstruct_detail.h"

namespace glint {

Outcome<Reconstruction> reconstructAnchored(const std::vector<ConicView>& views, const Eigen::Vector3d& centre,
                                            const ReconstructOptions& options) {
  if (const std::optional<Failure> failure = detail::check(views)) return *failure;
  if (!centre.allFinite()) return Failure{Reason::NotFinite, "centre"};
  if (views.size() < 2) return Failure{Reason::TooFewViews, "need 2, have " + std::to_string(views.size())};
  const detail::Normalisation world = detail::normalise(views, centre);

  // With the centre at the origin, P Q P^T = h h^T - M S M^T with h the last column of P. Projected across the measured conic
  // (which eliminates its scale) this is linear in the six entries of S; the seventh column is the right-hand side.
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, 7>;
  Rows rows = Rows::Zero(std::max<Eigen::Index>(6 * views.size(), 7), 7);
  for (std::size_t i = 0; i < views.size(); ++i) {
    const Eigen::Matrix3d m = world.views[i].projection.leftCols<3>();
    const Eigen::Vector3d h = world.views[i].projection.col(3);
    Eigen::Matrix<double, 6, 7> a;
    for (int k = 0; k < 6; ++k)
      a.col(k) = detail::vech(m * detail::symmetric(Eigen::Matrix<double, 6, 1>::Unit(k)) * m.transpose());
    a.col(6) = detail::vech(h * h.transpose());
    const Eigen::Matrix<double, 6, 1>& c = world.views[i].conic;
    rows.middleRows<6>(6 * i) = a - c * (c.transpose() * a);
  }
  const Eigen::Matrix<double, 7, 7> r = triangularFactor(rows);
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(r.topLeftCorner<6, 6>(), Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Matrix<double, 6, 1> s = svd.singularValues();
  if (!(s(5) > options.minRankRatio * s(0))) return Failure{Reason::RankDeficient, "several shapes about this centre fit"};
  Reconstruction result;
  result.solver = "anchored";
  const Eigen::Matrix<double, 7, 1> all = Eigen::JacobiSVD<Eigen::MatrixXd>(r).singularValues();
  result.singularValues.assign(all.data(), all.data() + 7);
  result.gapRatio = all(5) > 0 ? all(6) / all(5) : 1.0;
  result.condition = s(0) / s(5);

  const Eigen::Matrix<double, 6, 1> solution = svd.solve(r.topRightCorner<6, 1>());
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(detail::symmetric(solution));
  if (!solution.allFinite()) return Failure{Reason::NotFinite, "shape"};
  const Eigen::Vector3d squares = eigen.eigenvalues().cwiseMax(0.0);  // nearest positive semidefinite matrix
  if (!(squares(1) > 1e-12 * squares(2)))  // an axis below a millionth of the longest is the root of round-off
    return Failure{Reason::NotAnEllipsoid, "the shape fitted about this centre has two zero axes"};
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = eigen.eigenvectors();
  if (pose.linear().determinant() < 0) pose.linear().col(0) *= -1;
  pose.translation() = centre;
  result.ellipsoid = Ellipsoid(pose, world.scale * squares.cwiseSqrt());
  result.quadric = result.ellipsoid->dual();
  result.residualPx = detail::residuals(views, result);
  return result;
}

}  // namespace glint
