// SPDX-License-Identifier: BSD-3-Clause
#include "core/geometry/camera.h"

#include <Eigen/LU>
#include <cmath>
#include <limits>

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

namespace {

constexpr int kSteps = 8;  // along each side: its middle, where a border bulges most, is one of them

/// Where the ray of an ideal pixel is cut off: at 85 degrees from the axis, in its own direction.
Pixel withinReach(const Camera& camera, const Pixel& ideal) {
  static const double kLongest = std::tan(85 * EIGEN_PI / 180);
  const Eigen::Vector2d ray =
      (camera.pixelFromRay.topLeftCorner<2, 2>().inverse() * (ideal - camera.pixelFromRay.topRightCorner<2, 1>()));
  if (ray.norm() <= kLongest) return ideal;
  return camera.pixelFromRay.topRightCorner<2, 1>() + camera.pixelFromRay.topLeftCorner<2, 2>() * (kLongest * ray.normalized());
}

}  // namespace

Eigen::AlignedBox2d seenWindow(const Camera& camera) {
  const Eigen::AlignedBox2d measured(Pixel(-0.5, -0.5), Pixel(camera.width - 0.5, camera.height - 0.5));
  if (!camera.hasDistortion()) return measured;
  Eigen::AlignedBox2d seen;
  const Pixel centre = camera.pixelFromRay.topRightCorner<2, 1>();
  const auto add = [&](const Pixel& border) {
    if (const Outcome<Pixel> ideal = withoutDistortion(camera, border))
      seen.extend(withinReach(camera, *ideal));
    else if (ideal.failure().reason == Reason::OutsideImage)  // at 90 degrees and more: all up to where the window ends
      seen.extend(withinReach(camera, centre + 1e6 * (border - centre)));
  };
  for (int i = 0; i <= kSteps; ++i) {
    const double share = double(i) / kSteps;
    const Pixel along = measured.min() + share * measured.sizes();
    for (const Pixel& border : {Pixel(along.x(), measured.min().y()), Pixel(along.x(), measured.max().y()),
                                Pixel(measured.min().x(), along.y()), Pixel(measured.max().x(), along.y())})
      add(border);
  }
  // A strong distortion that shows nothing along the whole border, or an optical axis outside of the image.
  return seen.isEmpty() || !((seen.max() - seen.min()).minCoeff() > 0) ? measured : seen;
}

bool onImageBorder(const Camera& camera, const Pixel& ideal) {
  constexpr double kWidthPx = 0.5 + 1e-6;  // the image ends half a pixel beyond the outermost centres; the rest is round-off
  const auto near = [](double v, double last) { return std::abs(v) <= kWidthPx || std::abs(v - last) <= kWidthPx; };
  const Pixel p = camera.hasDistortion() ? camera.distorted(ideal) : ideal;
  return near(p.x(), camera.width - 1) || near(p.y(), camera.height - 1);
}

bool alongImageBorder(const Camera& camera, const Pixel& from, const Pixel& to) {
  constexpr double kSamePx =
      1e-3;  // far above what tracing a border and removing distortion leave; a level set leaves it at once
  const Pixel a = camera.distorted(from), b = camera.distorted(to);
  const auto along = [&](int axis, double border) {
    return std::abs(a(axis) - border) < kSamePx && std::abs(b(axis) - border) < kSamePx;
  };
  for (const double beyond : {0.0, 0.5})  // detected contours end at the outermost centres, others at the image's edge
    if (along(0, -beyond) || along(1, -beyond) || along(0, camera.width - 1 + beyond) || along(1, camera.height - 1 + beyond))
      return true;
  return false;
}

bool isInPhotograph(const Camera& camera, const Pixel& ideal, double marginPx) {
  const Pixel p = camera.hasDistortion() ? camera.distorted(ideal) : ideal;
  return p.x() >= -marginPx && p.y() >= -marginPx && p.x() <= camera.width - 1 + marginPx &&
         p.y() <= camera.height - 1 + marginPx;
}

}  // namespace glint
