// SPDX-License-Identifier: BSD-3-Clause
#include "core/light/directed_limit.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace glint {

double directedLimit(double limitAngle, const Eigen::Matrix3d& extent, const Eigen::Vector3d& point, const Eigen::Vector3d& n,
                     const Eigen::Vector3d& toCamera, const Eigen::Vector4d& light) {
  const Eigen::Vector3d plain = light.head<3>() - light.w() * point;
  const double distance = plain.norm();
  if (!(distance > 0)) return limitAngle;
  const Eigen::Vector3d l = (n.dot(plain) < 0 ? -1 : 1) * plain / distance, half = l + toCamera;
  const double length = half.norm();
  if (!(length > 0)) return limitAngle;
  const Eigen::Vector3d h = half / length, across = n - n.dot(h) * h;
  const double sine = across.norm();
  if (!(sine > 0)) return limitAngle;
  const Eigen::Vector3d t = across / sine, p = h.cross(t);
  const double k = (light.w() != 0 ? std::abs(light.w()) / distance : 1.0) / length;
  const Eigen::Vector3d u = k * (t - l * l.dot(t)), v = k * (p - l * l.dot(p));
  const double a2 = limitAngle * limitAngle, tt = a2 + u.dot(extent * u), pp = a2 + v.dot(extent * v), tp = u.dot(extent * v);
  constexpr double kLeast = 0.01;  // an extent may come out slightly negative where the views do not support it
  const double radius2 = tt - tp * tp / std::max(pp, kLeast * a2);
  return std::sqrt(std::max(radius2, kLeast * a2));
}

}  // namespace glint
