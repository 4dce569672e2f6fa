// SPDX-License-Identifier: BSD-3-Clause
#include "core/geometry/camera.h"

#include <Eigen/LU>
#include <algorithm>
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
/// Its derivative.
Eigen::Matrix2d distortionSlope(const Eigen::Vector2d& x, const Distortion& d) {
  const double r2 = x.squaredNorm();
  const double radial = 1 + r2 * (d[0] + r2 * (d[1] + r2 * d[4]));
  const double byR2 = d[0] + r2 * (2 * d[1] + 3 * r2 * d[4]);
  Eigen::Matrix2d j = radial * Eigen::Matrix2d::Identity() + 2 * byR2 * x * x.transpose();
  j(0, 0) += 2 * d[2] * x.y() + 6 * d[3] * x.x();
  j(0, 1) += 2 * d[2] * x.x() + 2 * d[3] * x.y();
  j(1, 0) += 2 * d[2] * x.x() + 2 * d[3] * x.y();
  j(1, 1) += 6 * d[2] * x.y() + 2 * d[3] * x.x();
  return j;
}
}  // namespace

Pixel Camera::distorted(const Pixel& ideal) const {
  if (!hasDistortion()) return ideal;
  const Eigen::Vector3d x = pixelFromRay.triangularView<Eigen::Upper>().solve(ideal.homogeneous());
  return (pixelFromRay * distort(x.head<2>() / x.z(), distortion).homogeneous()).head<2>();
}

Pixel Camera::undistorted(const Pixel& measured) const {
  const Outcome<Pixel> ideal = withoutDistortion(*this, measured);
  return ideal ? *ideal : Pixel::Constant(std::numeric_limits<double>::quiet_NaN());
}

// Not OpenCV's undistortPoints: it answers beyond the fold, too, and does not say so.
Outcome<Pixel> withoutDistortion(const Camera& camera, const Pixel& measured) {
  if (!measured.allFinite()) return Failure{Reason::NotFinite, "pixel"};
  if (!camera.hasDistortion()) return measured;
  const Distortion& d = camera.distortion;
  const Eigen::Vector3d h = camera.pixelFromRay.triangularView<Eigen::Upper>().solve(measured.homogeneous());
  const Eigen::Vector2d target = h.head<2>() / h.z();
  const double size = std::max(1.0, target.norm());

  // At the centre the model is the identity, so its determinant is 1 there and falls to 0 at the fold. A step is taken only when
  // it brings the target nearer and stays on this side of the fold.
  const auto onBranch = [&](const Eigen::Vector2d& x) {
    constexpr int kSteps = 16;  // a polynomial of degree 7 turns at most three times on the way
    for (int i = 1; i <= kSteps; ++i)
      if (!(distortionSlope(x * (double(i) / kSteps), d).determinant() > 0)) return false;
    return true;
  };
  Eigen::Vector2d x = onBranch(target) ? target : Eigen::Vector2d(0, 0);
  Eigen::Vector2d error = target - distort(x, d);
  constexpr int kMaxIterations = 100;
  for (int i = 0; i < kMaxIterations && error.norm() > 1e-16 * size; ++i) {  // round-off of the target itself
    const Eigen::Vector2d step = distortionSlope(x, d).partialPivLu().solve(error);
    bool moved = false;
    for (double share = 1; share > 1e-6; share *= 0.5) {  // shorter steps than a millionth are a fold, not a curve
      const Eigen::Vector2d next = x + share * step, rest = target - distort(next, d);
      if (!(rest.norm() < error.norm()) || !onBranch(next)) continue;
      x = next;
      error = rest;
      moved = true;
      break;
    }
    if (!moved) break;
  }
  // A few units of round-off of the polynomial; anything larger is a fold that Newton's method ran into.
  if (!(error.norm() <= 1e-14 * size))
    return Failure{Reason::NotConverged, "no ideal pixel maps there: the lens distortion folds back before it"};
  return Pixel((camera.pixelFromRay * x.homogeneous()).head<2>());
}

}  // namespace glint
