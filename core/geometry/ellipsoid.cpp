// SPDX-License-Identifier: BSD-3-Clause
#include "core/geometry/ellipsoid.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace glint {
namespace {
constexpr double kZero = 1e-12;  // share of the largest eigenvalue below which one counts as 0
constexpr double kUnitRoundOff = std::numeric_limits<double>::epsilon();

/// @param slack  absolute round-off of `shape`'s entries.
Outcome<Ellipsoid> fromShape(const Eigen::Vector3d& centre, const Eigen::Matrix3d& shape, double slack) {
  if (!centre.allFinite() || !shape.allFinite()) return Failure{Reason::NotFinite, "ellipsoid"};
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(0.5 * (shape + shape.transpose()));
  const Eigen::Vector3d values = eigen.eigenvalues();  // ascending
  const double limit = std::max(kZero * values.cwiseAbs().maxCoeff(), slack);
  if (values(0) < -limit) return Failure{Reason::NotAnEllipsoid, "the shape has a negative eigenvalue"};
  if (!(values(1) > limit)) return Failure{Reason::NotAnEllipsoid, "more than one axis is zero"};
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = centre;
  pose.linear() = eigen.eigenvectors();
  if (pose.linear().determinant() < 0) pose.linear().col(0) *= -1;
  return Ellipsoid(pose, values.cwiseMax(0.0).cwiseSqrt());
}

/// Centre and shape of Q* scaled to (3,3) = 1; the round-off of the shape comes with them.
struct CentreShape {
  Eigen::Vector3d centre;
  Eigen::Matrix3d shape;
  double slack;
};
std::optional<CentreShape> centreAndShape(const DualQuadric& dual) {
  const Eigen::Matrix4d q = dual.matrix / dual.matrix.cwiseAbs().maxCoeff();
  const double w = q(3, 3);
  if (w == 0) return std::nullopt;
  const Eigen::Vector3d c = 0.5 * (q.topRightCorner<3, 1>() + q.bottomLeftCorner<1, 3>().transpose()) / w;
  const Eigen::Matrix3d cc = c * c.transpose(), upper = q.topLeftCorner<3, 3>() / w;
  CentreShape result{c, cc - 0.5 * (upper + upper.transpose()), 8 * kUnitRoundOff * (cc.norm() + upper.norm())};
  if (!result.shape.allFinite() || !c.allFinite()) return std::nullopt;
  return result;
}
}  // namespace

Ellipsoid::Ellipsoid(const Eigen::Isometry3d& worldFromBody, const Eigen::Vector3d& semiAxes) {
  require(worldFromBody.matrix().allFinite() && semiAxes.allFinite(), "Ellipsoid: not finite");
  require(semiAxes.minCoeff() >= 0, "Ellipsoid: negative semi-axis");
  require((semiAxes.array() == 0).count() <= 1, "Ellipsoid: more than one zero semi-axis");
  std::array<int, 3> order{0, 1, 2};
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return semiAxes(a) > semiAxes(b); });
  worldFromBody_ = worldFromBody;
  for (int i = 0; i < 3; ++i) {
    worldFromBody_.linear().col(i) = worldFromBody.linear().col(order[i]);
    semiAxes_(i) = semiAxes(order[i]);
  }
  // An odd permutation mirrors the frame; the ellipsoid does not notice a flipped axis.
  if (worldFromBody_.linear().determinant() < 0) worldFromBody_.linear().col(2) *= -1;
}

Outcome<Ellipsoid> Ellipsoid::fromCentreAndShape(const Eigen::Vector3d& centre, const Eigen::Matrix3d& shape) {
  return fromShape(centre, shape, 0.0);
}

Outcome<Ellipsoid> Ellipsoid::fromDual(const DualQuadric& dual) {
  if (!dual.matrix.allFinite()) return Failure{Reason::NotFinite, "dual quadric"};
  if (dual.matrix.cwiseAbs().maxCoeff() == 0) return Failure{Reason::NotAnEllipsoid, "zero matrix"};
  const std::optional<CentreShape> parts = centreAndShape(dual);
  if (!parts) return Failure{Reason::NotAnEllipsoid, "the quadric lies at infinity"};
  const Outcome<Ellipsoid> e = fromShape(parts->centre, parts->shape, parts->slack);
  if (!e && e.failure().reason == Reason::NotAnEllipsoid) return Failure{Reason::NotAnEllipsoid, describe(dual)};
  return e;
}

DualQuadric Ellipsoid::dual() const {
  const Eigen::Vector3d c = centre();
  DualQuadric q;
  q.matrix << c * c.transpose() - shape(), c, c.transpose(), 1.0;
  return q;
}

Eigen::Matrix3d Ellipsoid::shape() const {
  const Eigen::Matrix3d root = worldFromBody_.linear() * semiAxes_.asDiagonal();
  return root * root.transpose();
}

DualConic outline(const DualQuadric& quadric, const Projection& projection) {
  const Eigen::Matrix3d c = projection.matrix * quadric.matrix * projection.matrix.transpose();
  return {0.5 * (c + c.transpose())};
}

Outcome<Ellipse> outlineEllipse(const Ellipsoid& ellipsoid, const Projection& projection) {
  // With h the projected centre and G the projected axes, C* = h h^T - G G^T. Measured from the centre's pixel, the outline's
  // centre and shape are sums of positive terms: nothing cancels, however small or far the ellipsoid is.
  const Eigen::Vector3d h = projection.matrix * ellipsoid.centre().homogeneous();
  const Eigen::Matrix3d g =
      projection.matrix.leftCols<3>() * ellipsoid.worldFromBody().linear() * ellipsoid.semiAxes().asDiagonal();
  if (!h.allFinite() || !g.allFinite()) return Failure{Reason::NotFinite, "projection"};
  const double reach = g.row(2).norm();
  if (std::abs(h.z()) <= reach) return Failure{Reason::NotAnEllipse, "the ellipsoid meets the plane through the camera centre"};
  if (h.z() < 0) return Failure{Reason::BehindCamera, "ellipsoid"};
  const Pixel origin = h.head<2>() / h.z();
  const Eigen::Matrix<double, 2, 3> spread = g.topRows<2>() - origin * g.row(2);
  const double d = (h.z() - reach) * (h.z() + reach);
  const Eigen::Vector2d offset = -(spread * g.row(2).transpose()) / d;
  const Eigen::Matrix2d shape = offset * offset.transpose() + spread * spread.transpose() / d;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(shape);
  if (!(eigen.eigenvalues()(0) > 4 * kUnitRoundOff * eigen.eigenvalues()(1)))
    return Failure{Reason::NotAnEllipse, "the outline is a segment (flat ellipsoid seen edge-on)"};
  Ellipse e;
  e.centre = origin + offset;
  e.semiAxes = eigen.eigenvalues().reverse().cwiseSqrt();
  const Eigen::Vector2d major = eigen.eigenvectors().col(1);
  e.angle = eigen.eigenvalues()(0) == eigen.eigenvalues()(1) ? 0.0 : std::atan(major.y() / major.x());
  if (!e.centre.allFinite() || !e.semiAxes.allFinite()) return Failure{Reason::NotFinite, "outline"};
  if (e.angle == -std::atan(std::numeric_limits<double>::infinity())) e.angle = -e.angle;
  return e;
}

Signature signatureOf(const DualQuadric& quadric) {
  Signature s;
  const auto count = [&](double value, double limit) {
    if (value > limit)
      ++s.positive;
    else if (value < -limit)
      ++s.negative;
    else
      ++s.zero;
  };
  if (!quadric.matrix.allFinite() || quadric.matrix.cwiseAbs().maxCoeff() == 0) return {0, 0, 4};
  if (const std::optional<CentreShape> parts = centreAndShape(quadric)) {
    // By Sylvester's law the signs are those of (3,3) and of -S; the split does not depend on the unit of length.
    const Eigen::Vector3d values =
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(parts->shape, Eigen::EigenvaluesOnly).eigenvalues();
    const double limit = std::max(kZero * values.cwiseAbs().maxCoeff(), parts->slack);
    for (int i = 0; i < 3; ++i) count(-values(i), limit);
    ++s.positive;
    return s;
  }
  const Eigen::Matrix4d q = quadric.matrix / quadric.matrix.cwiseAbs().maxCoeff();
  const Eigen::Vector4d values =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d>(0.5 * (q + q.transpose()), Eigen::EigenvaluesOnly).eigenvalues();
  for (int i = 0; i < 4; ++i) count(values(i), kZero * values.cwiseAbs().maxCoeff());
  return s;
}

const char* describe(const DualQuadric& quadric) {
  if (!quadric.matrix.allFinite()) return "not finite";
  if (quadric.matrix.cwiseAbs().maxCoeff() == 0) return "empty quadric";
  const Signature s = signatureOf(quadric);
  if (!centreAndShape(quadric)) return s.zero == 0 ? "paraboloid" : "quadric at infinity";
  // Positive semi-axes squared appear as negative signs beside the positive (3,3).
  const int squared = s.negative, imaginary = s.positive - 1;
  if (s.zero == 0) {
    if (squared == 3) return "ellipsoid";
    if (squared == 2) return "hyperboloid of one sheet";
    if (squared == 1) return "hyperboloid of two sheets";
    return "imaginary ellipsoid";
  }
  if (s.zero == 1) {
    if (squared == 2) return "flat ellipsoid";
    if (imaginary == 2) return "flat imaginary ellipsoid";
    return "flat hyperboloid";
  }
  if (s.zero == 2) return squared == 1 ? "segment" : "imaginary segment";
  return "point";
}

}  // namespace glint
