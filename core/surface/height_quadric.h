// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Internal to core/surface: a quadric over a plane, fitted to points.

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <optional>

namespace glint {

/// z = a + b x + c y + d x^2 + e x y + f y^2 by weighted least squares, with z along a plane's normal, from its origin.
class HeightQuadric {
 public:
  struct Fitted {
    double height = 0;            ///< a
    Eigen::Vector3d normal;       ///< ~ (-b, -c, 1) in the world, at the point above the origin
    double leverage = 0;          ///< variance of both slopes together, for noise of 1, in units of the reach
    double leverageOfOrigin = 0;  ///< share of a point at the origin, of weight 1, in its own height
  };

  /// @param frame  columns: normal, then two axes of the plane. @param reach  of the points: the equations are in units of it,
  ///               so that they have the same condition at every scale.
  HeightQuadric(const Eigen::Matrix3d& frame, double reach) : frame_(frame), reach_(reach) {}

  /// @param d  from the origin. @param count  of points whose mean this is: it has as much less noise.
  void add(const Eigen::Vector3d& d, double w, double count = 1) {
    const Eigen::Vector3d q = frame_.transpose() * d / reach_;
    const Vector6 row = (Vector6() << 1, q.y(), q.z(), q.y() * q.y(), q.y() * q.z(), q.z() * q.z()).finished();
    a_ += count * w * row * row.transpose();
    aw_ += count * w * w * row * row.transpose();
    b_ += count * w * row * q.x();
  }

  /// Nothing where the points determine no quadric.
  std::optional<Fitted> solve() const {
    const Eigen::LDLT<Matrix6> solver(a_);
    constexpr double kRegular = 1e-8;  // neighbours on a conic, a line for one, determine no quadric
    if (solver.info() != Eigen::Success || !(solver.rcond() > kRegular)) return std::nullopt;
    const Vector6 c = solver.solve(b_);
    const Matrix6 inverse = solver.solve(Matrix6::Identity());
    const Matrix6 covariance = inverse * aw_ * inverse;
    Fitted fitted;
    fitted.height = c[0] * reach_;
    fitted.normal = (frame_.col(0) - c[1] * frame_.col(1) - c[2] * frame_.col(2)).normalized();
    fitted.leverage = covariance(1, 1) + covariance(2, 2);
    fitted.leverageOfOrigin = inverse(0, 0);
    return fitted;
  }

 private:
  using Vector6 = Eigen::Matrix<double, 6, 1>;
  using Matrix6 = Eigen::Matrix<double, 6, 6>;
  Eigen::Matrix3d frame_;
  double reach_;
  Matrix6 a_ = Matrix6::Zero(), aw_ = Matrix6::Zero();
  Vector6 b_ = Vector6::Zero();
};

}  // namespace glint
