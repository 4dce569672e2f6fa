// SPDX-License-Identifier: BSD-3-Clause
#include "core/geometry/camera.h"

namespace glint {

Eigen::Vector3d Camera::centreInWorld() const { return -(camFromWorld.linear().transpose() * camFromWorld.translation()); }

Projection Camera::projection() const { return {pixelFromRay * camFromWorld.matrix().topRows<3>()}; }

Ray Camera::ray(const Pixel& p) const {
  // K is upper triangular: back substitution instead of an inverse.
  const Eigen::Vector3d d = pixelFromRay.triangularView<Eigen::Upper>().solve(p.homogeneous());
  return {centreInWorld(), (camFromWorld.linear().transpose() * d).normalized()};
}

std::optional<Pixel> Camera::project(const Eigen::Vector3d& x) const {
  const Eigen::Vector3d c = camFromWorld * x;
  if (!(c.z() > 0)) return std::nullopt;
  const Eigen::Vector3d h = pixelFromRay * c;
  return Pixel(h.head<2>() / h.z());
}

double Camera::depth(const Eigen::Vector3d& x) const { return (camFromWorld * x).z(); }

bool Camera::hasDistortion() const {
  for (const double d : distortion)
    if (d != 0) return true;
  return false;
}

namespace {
/// Brown-Conrady on normalised image coordinates.
Eigen::Vector2d distort(const Eigen::Vector2d& x, const Distortion& d) {
  const double r2 = x.squaredNorm();
  const double radial = 1 + r2 * (d[0] + r2 * (d[1] + r2 * d[4]));
  return {x.x() * radial + 2 * d[2] * x.x() * x.y() + d[3] * (r2 + 2 * x.x() * x.x()),
          x.y() * radial + d[2] * (r2 + 2 * x.y() * x.y()) + 2 * d[3] * x.x() * x.y()};
}
}  // namespace

Pixel Camera::distorted(const Pixel& ideal) const {
  if (!hasDistortion()) return ideal;
  const Eigen::Vector3d x = pixelFromRay.triangularView<Eigen::Upper>().solve(ideal.homogeneous());
  return (pixelFromRay * distort(x.head<2>() / x.z(), distortion).homogeneous()).head<2>();
}

Pixel Camera::undistorted(const Pixel& measured) const {
  if (!hasDistortion()) return measured;
  const Eigen::Vector3d h = pixelFromRay.triangularView<Eigen::Upper>().solve(measured.homogeneous());
  const Eigen::Vector2d target = h.head<2>() / h.z();
  Eigen::Vector2d x = target;
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector2d error = target - distort(x, distortion);
    x += error;
    if (!(error.norm() > 1e-13)) break;
  }
  return (pixelFromRay * x.homogeneous()).head<2>();
}

}  // namespace glint
