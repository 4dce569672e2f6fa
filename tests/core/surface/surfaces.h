// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>

#include "core/surface/analytic.h"

/// Specifications and poses that the surface tests share.
namespace glint::test {

inline AnalyticSpec plane() {
  AnalyticSpec s;
  s.type = "plane";
  return s;
}
inline AnalyticSpec sphere(double radius) {
  AnalyticSpec s;
  s.type = "sphere";
  s.radius = radius;
  return s;
}
inline AnalyticSpec ellipsoid(double a, double b, double c) {
  AnalyticSpec s;
  s.type = "ellipsoid";
  s.semiAxes = {a, b, c};
  return s;
}
inline AnalyticSpec cylinder(double radius) {
  AnalyticSpec s;
  s.type = "cylinder";
  s.radius = radius;
  return s;
}
inline AnalyticSpec sheet(double curvature, std::optional<double> length = {}, std::optional<double> width = {}) {
  AnalyticSpec s;
  s.type = "sheet";
  s.curvature = curvature;
  s.length = length;
  s.width = width;
  return s;
}
inline AnalyticSpec torus(double majorRadius, double minorRadius) {
  AnalyticSpec s;
  s.type = "torus";
  s.majorRadius = majorRadius;
  s.minorRadius = minorRadius;
  return s;
}
/// x^2 - y^2 + z = 0.
inline AnalyticSpec saddle() {
  AnalyticSpec s;
  s.type = "quadric";
  s.matrix.diagonal() << 1, -1, 0, 0;
  s.matrix(2, 3) = s.matrix(3, 2) = 0.5;
  return s;
}

/// A rotation about a slanted axis and a translation.
inline Eigen::Isometry3d pose(double angle, const Eigen::Vector3d& t) {
  Eigen::Isometry3d m = Eigen::Isometry3d::Identity();
  m.linear() = Eigen::AngleAxisd(angle, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  m.translation() = t;
  return m;
}

/// A camera at `eye` that looks at `target`, world +z up in the image (or +y when it looks along z).
inline Camera lookAt(const Eigen::Vector3d& eye, const Eigen::Vector3d& target, double focal = 800, int width = 640,
                     int height = 480) {
  const Eigen::Vector3d z = (target - eye).normalized();
  const Eigen::Vector3d up = std::abs(z.z()) > 0.99 ? Eigen::Vector3d::UnitY() : Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d x = z.cross(up).normalized(), y = z.cross(x);
  Camera camera;
  Eigen::Matrix3d r;
  r << x.transpose(), y.transpose(), z.transpose();
  camera.camFromWorld.linear() = r;
  camera.camFromWorld.translation() = -r * eye;
  camera.pixelFromRay << focal, 0, 0.5 * (width - 1), 0, focal, 0.5 * (height - 1), 0, 0, 1;
  camera.width = width;
  camera.height = height;
  return camera;
}

}  // namespace glint::test
