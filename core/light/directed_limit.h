// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace glint {

/// Limit angle in the direction in which a surface point lies off the mirror direction, for a light that is not a point.
///
/// A lobe that falls as a Gaussian of the half vector, seen from a light with some second moment, falls as the wider Gaussian
/// whose covariance is the sum: the limit angle a becomes the radius of the ellipse of M = a^2 I + B, B the extent carried to the
/// half vector's tangent plane, B = A E A^T, A = (I - H H^T)(I - L L^T) / (r |L + V|). In the direction t (across H towards N),
/// with p = H x t: radius^2 = det M / (p^T M p). As a series over the azimuth, its even terms contain the frame, the
/// foreshortening and the distance of each view, so that the same six numbers hold for all views.
/// @param limitAngle  a > 0, rad
/// @param extent      E, symmetric, m^2 (rad^2 for a light at infinity): -2 log q times the second moment of the light
///                    about `light`
/// @param n,toCamera  unit vectors away from the surface
/// @param light       (l, w) of any scale, seen with N.L > 0
/// @return rad; at least a tenth of a, whatever the extent
double directedLimit(double limitAngle, const Eigen::Matrix3d& extent, const Eigen::Vector3d& point, const Eigen::Vector3d& n,
                     const Eigen::Vector3d& toCamera, const Eigen::Vector4d& light);

using Vector6 = Eigen::Matrix<double, 6, 1>;

/// The six entries xx yy zz xy xz yz of an extent.
inline Eigen::Matrix3d symmetric(const Vector6& e) {
  return Eigen::Matrix3d{{e(0), e(3), e(4)}, {e(3), e(1), e(5)}, {e(4), e(5), e(2)}};
}

/// directedLimit() with its derivatives, rad per unit of what they are taken by.
struct DirectedLimit {
  double angle = 0;    ///< rad
  double byLimit = 1;  ///< by the limit angle
  Eigen::Vector4d byLight = Eigen::Vector4d::Zero();
  Vector6 byExtent = Vector6::Zero();  ///< by xx yy zz xy xz yz
};
DirectedLimit directedLimitWithDerivatives(double limitAngle, const Eigen::Matrix3d& extent, const Eigen::Vector3d& point,
                                           const Eigen::Vector3d& n, const Eigen::Vector3d& toCamera,
                                           const Eigen::Vector4d& light);

}  // namespace glint
