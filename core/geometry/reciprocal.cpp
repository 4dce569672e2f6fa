// SPDX-License-Identifier: BSD-3-Clause
#include "core/geometry/reciprocal.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>
#include <limits>

namespace glint {
namespace {
constexpr double kLeastEigenvalue = 1e-12;  // share of the largest: below, round-off decides whether the dual is bounded
constexpr double kLeastDistance = 8 * std::numeric_limits<double>::epsilon();  // of the terms that cancel: below, it is round-off
}  // namespace

Outcome<Eigen::Vector3d> centreOf(const Projection& projection) {
  if (!projection.matrix.allFinite()) return Failure{Reason::NotFinite, "projection"};
  const Eigen::FullPivLU<Eigen::Matrix3d> left(projection.matrix.leftCols<3>());
  if (!left.isInvertible()) return Failure{Reason::RankDeficient, "the centre of projection is at infinity"};
  const Eigen::Vector3d centre = -left.solve(projection.matrix.col(3));
  if (!centre.allFinite()) return Failure{Reason::NotFinite, "centre of projection"};
  return centre;
}

Outcome<std::vector<ConePlane>> conePlanes(const Projection& projection, const Ellipse& ellipse, int n) {
  require(n >= 3, "conePlanes: at least three planes");
  const Outcome<Eigen::Vector3d> centre = centreOf(projection);
  if (!centre) return centre.failure();
  const Eigen::Matrix3d left = projection.matrix.leftCols<3>();
  const Eigen::FullPivLU<Eigen::Matrix3d> rayFromPixel(left);
  const Eigen::Matrix3d conic = ellipse.conic().matrix;
  std::vector<ConePlane> planes;
  for (const Pixel& contact : ellipse.sample(n)) {
    const Eigen::Vector3d x = contact.homogeneous();
    // l.x < 0 inside the ellipse, and so is pi.X in front of the camera.
    const Eigen::Vector3d normal = (left.transpose() * (conic * x)).normalized();
    const Eigen::Vector3d along = rayFromPixel.solve(x).normalized();
    if (!normal.allFinite() || !along.allFinite()) return Failure{Reason::NotFinite, "tangent plane"};
    // Through the centre, exactly: P^T l brings its rounding from the world's origin.
    planes.push_back({Plane::through(*centre, normal), along, contact});
  }
  return planes;
}

Outcome<Eigen::Vector3d> dualPoint(const Plane& plane, const Reciprocal& chart) {
  require(chart.radius > 0, "dualPoint: the radius of the chart must be positive");
  const double away = -plane.signedDistance(chart.centre);
  if (!std::isfinite(away)) return Failure{Reason::NotFinite, "plane"};
  const double cancels = chart.centre.norm() + std::abs(plane.offset);
  if (!(std::abs(away) > kLeastDistance * cancels))
    return Failure{Reason::RankDeficient, "the plane goes through the centre of the chart: its dual point is at infinity"};
  return Eigen::Vector3d(chart.radius * chart.radius / away * plane.normal);
}

Outcome<Ellipsoid> reciprocal(const Ellipsoid& ellipsoid, const Reciprocal& chart) {
  require(chart.radius > 0, "reciprocal: the radius of the chart must be positive");
  const Eigen::Vector3d c = ellipsoid.centre() - chart.centre;
  if (!c.allFinite()) return Failure{Reason::NotFinite, "chart"};
  if (!(ellipsoid.semiAxes().minCoeff() > 0))
    return Failure{Reason::NotAnEllipsoid, "the ellipsoid is flat: its dual is unbounded along the missing axis"};
  const Eigen::Matrix3d a = ellipsoid.shape() - c * c.transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(a);
  if (!(eigen.eigenvalues()(0) > kLeastEigenvalue * eigen.eigenvalues().cwiseAbs().maxCoeff()))
    return Failure{Reason::NotAnEllipsoid, "the centre of the chart is not inside of the ellipsoid"};
  const Eigen::Matrix3d inverse = a.inverse();
  const double square = chart.radius * chart.radius;
  const Eigen::Vector3d offset = inverse * c;
  return Ellipsoid::fromCentreAndShape(-square * offset, square * square * (1 + c.dot(offset)) * inverse);
}

}  // namespace glint
