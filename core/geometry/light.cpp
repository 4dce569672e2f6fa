// SPDX-License-Identifier: BSD-3-Clause
#include "core/geometry/light.h"

#include <Eigen/Geometry>
#include <cmath>

namespace glint {

Light Light::homogeneous(const Eigen::Vector4d& lw) {
  require(lw.allFinite(), "Light: not finite");
  const double scale = lw.cwiseAbs().maxCoeff();  // first, so that the norm neither overflows nor underflows
  require(scale > 0, "Light: zero vector");
  Light light;
  light.lw_ = (lw / scale).normalized();
  if (light.lw_.w() < 0) light.lw_ = -light.lw_;
  return light;
}

Light Light::at(const Eigen::Vector3d& p) { return homogeneous(Eigen::Vector4d(p.x(), p.y(), p.z(), 1)); }
Light Light::towards(const Eigen::Vector3d& d) { return homogeneous(Eigen::Vector4d(d.x(), d.y(), d.z(), 0)); }

double incidentAngle(const Eigen::Vector3d& n, const Eigen::Vector3d& toLight, const Eigen::Vector3d& toCamera) {
  const Eigen::Vector3d h = toLight + toCamera;
  const double length = h.norm();
  if (length == 0) return std::nan("");
  return std::atan2(n.cross(h).norm(), n.dot(h));
}

Eigen::Vector4d incidentAngleByLight(const Eigen::Vector3d& point, const Eigen::Vector3d& n, const Eigen::Vector3d& toCamera,
                                     const Eigen::Vector4d& light) {
  const Eigen::Vector3d plain = light.head<3>() - light.w() * point;
  const double sign = n.dot(plain) < 0 ? -1 : 1, distance = plain.norm();
  const Eigen::Vector3d toLight = sign * plain / distance, half = toLight + toCamera;
  const double length = half.norm();
  const Eigen::Vector3d h = half / length;
  const double sine = n.cross(h).norm(), cosine = n.dot(h);
  Eigen::Vector4d gradient = Eigen::Vector4d::Zero();
  if (!(distance > 0 && length > 0 && sine > 0)) return gradient;
  const Eigen::Vector3d t = (n - cosine * h) / sine;
  gradient.head<3>() = -(sign / (length * distance)) * (t - toLight * toLight.dot(t));
  gradient.w() = -gradient.head<3>().dot(point);
  return gradient;
}

}  // namespace glint
