// SPDX-License-Identifier: BSD-3-Clause
#include "core/what_if/drag.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/geometry/polyline.h"

namespace glint {

namespace {
constexpr double kSmallest = 0.05, kLargest = 20;  // of a contour: beyond, it is a point or fills the picture

/// Rotation vector of the camera's new axes in those it has now, so that what was seen at `from` is seen at `to`.
Eigen::Matrix3d turn(const Camera& camera, const Pixel& from, const Pixel& to) {
  const Eigen::Matrix3d rayFromPixel = camera.pixelFromRay.inverse();
  const Eigen::Vector3d was = rayFromPixel * from.homogeneous(), is = rayFromPixel * to.homogeneous();
  return Eigen::Quaterniond::FromTwoVectors(is, was).toRotationMatrix();
}

Eigen::Matrix3d matrixOf(const Eigen::Vector3d& rotation) {
  const double angle = rotation.norm();
  if (!(angle > 0)) return Eigen::Matrix3d::Identity();
  return Eigen::AngleAxisd(angle, rotation / angle).toRotationMatrix();
}
}  // namespace

WhatIf dragged(const WhatIf& start, Held held, int frame, const Camera& camera, int highlight, const Highlight& now,
               const Pixel& from, const Pixel& to) {
  WhatIf w = start;
  if (!from.allFinite() || !to.allFinite() || from == to) return w;
  if (held == Held::Camera) {
    PoseChange& change = w.poses[frame];
    const Eigen::AngleAxisd angle(matrixOf(change.rotation) * turn(camera, from, to));
    change.rotation = angle.angle() * angle.axis();
    return w;
  }
  HighlightChange& change = w.highlights[{frame, highlight}];
  if (held == Held::Peak) change.peakBy += to - from;
  if (held == Held::Contour) change.contourBy += to - from;
  if (held == Held::ContourSize) {
    const Pixel centre = centroid(now.contour);
    const double factor = (to - centre).norm() / (from - centre).norm();
    if (!std::isfinite(factor)) return start;
    change.contourScale = std::clamp(change.contourScale * factor, kSmallest, kLargest);
  }
  return w;
}

WhatIf draggedLight(const WhatIf& start, const TrueLight& light, const Eigen::Vector3d& by) {
  WhatIf w = start;
  if (light.lamp.atInfinity() || !by.allFinite() || by.isZero(0)) return w;
  w.lightsBy.try_emplace(light.id, Eigen::Vector3d::Zero()).first->second += by;
  return w;
}

}  // namespace glint
