// SPDX-License-Identifier: BSD-3-Clause
#include "core/geometry/camera.h"

#include <Eigen/LU>
#include <limits>

#include "core/geometry/distortion.h"

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

Pixel Camera::distorted(const Pixel& ideal) const {
  if (!hasDistortion()) return ideal;
  const Eigen::Vector3d x = pixelFromRay.triangularView<Eigen::Upper>().solve(ideal.homogeneous());
  return (pixelFromRay * glint::distorted(lens, x.head<2>() / x.z()).homogeneous()).head<2>();
}

Pixel Camera::undistorted(const Pixel& measured) const {
  const Outcome<Pixel> ideal = withoutDistortion(*this, measured);
  return ideal ? *ideal : Pixel::Constant(std::numeric_limits<double>::quiet_NaN());
}

Outcome<Pixel> withoutDistortion(const Camera& camera, const Pixel& measured) {
  if (!measured.allFinite()) return Failure{Reason::NotFinite, "pixel"};
  if (!camera.hasDistortion()) return measured;
  const Eigen::Vector3d h = camera.pixelFromRay.triangularView<Eigen::Upper>().solve(measured.homogeneous());
  const Outcome<Eigen::Vector2d> x = undistorted(camera.lens, h.head<2>() / h.z());
  if (!x) return x.failure();
  return Pixel((camera.pixelFromRay * x->homogeneous()).head<2>());
}

}  // namespace glint
