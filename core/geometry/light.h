// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "core/base/outcome.h"

namespace glint {

/// A point light, finite or at infinity: L = (l, w), |L| = 1, w >= 0 (method.md section 4).
class Light {
 public:
  static Light at(const Eigen::Vector3d& positionInWorld);
  /// @param fromScene  direction from the scene to the light; normalised here. std::invalid_argument if zero.
  static Light towards(const Eigen::Vector3d& fromScene);
  /// Any non-zero multiple; w < 0 flips the sign. std::invalid_argument if zero or not finite.
  static Light homogeneous(const Eigen::Vector4d& lw);
  /// @param lw  of length 1 to round-off, w >= 0: kept digit by digit
  static Light ofUnit(const Eigen::Vector4d& lw) {
    Light light;
    light.lw_ = lw;
    return light;
  }

  const Eigen::Vector4d& homogeneous() const { return lw_; }
  bool atInfinity() const { return lw_.w() == 0; }
  /// Position l / w. Not finite for a light at infinity.
  Eigen::Vector3d position() const { return lw_.head<3>() / lw_.w(); }
  /// unit(l - w P): from a world point to the light.
  Eigen::Vector3d directionFrom(const Eigen::Vector3d& point) const { return (lw_.head<3>() - lw_.w() * point).normalized(); }

 private:
  Eigen::Vector4d lw_{0, 0, 1, 0};
};

/// Incident angle alpha = angle(N, H), H = unit(L + V), by atan2(|N x H|, N.H): full precision near 0. Radians.
/// @param n,toLight,toCamera  unit vectors away from the surface. L = -V gives NaN.
double incidentAngle(const Eigen::Vector3d& n, const Eigen::Vector3d& toLight, const Eigen::Vector3d& toCamera);

/// d alpha / d (l, w) at a point, for the light (l, w) of any scale seen with N.L > 0: d alpha = -t . dL / |L + V| with t the
/// unit vector across H towards N. Zero at alpha = 0, where alpha has a cusp.
/// @param n,toCamera  unit vectors away from the surface.
Eigen::Vector4d incidentAngleByLight(const Eigen::Vector3d& point, const Eigen::Vector3d& n, const Eigen::Vector3d& toCamera,
                                     const Eigen::Vector4d& light);

/// Mirror direction; `toCamera` and the result both point away from the surface. r = 2 (v.N) N - v.
inline Eigen::Vector3d reflect(const Eigen::Vector3d& toCamera, const Eigen::Vector3d& n) {
  return 2.0 * n.dot(toCamera) * n - toCamera;
}

}  // namespace glint
