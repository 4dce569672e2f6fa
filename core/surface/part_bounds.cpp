// SPDX-License-Identifier: BSD-3-Clause
#include "core/surface/part_bounds.h"

namespace glint {

std::array<Eigen::Vector3d, 4> sidesOf(const Camera& camera, const Pixel& min, const Pixel& max) {
  const Pixel corners[4] = {min, {max.x(), min.y()}, max, {min.x(), max.y()}};
  const Eigen::Matrix3d pixelFromWorld = camera.pixelFromRay * camera.camFromWorld.linear();
  std::array<Eigen::Vector3d, 4> sides;
  const Eigen::Vector3d middle(0.5 * (min.x() + max.x()), 0.5 * (min.y() + max.y()), 1);
  for (int k = 0; k < 4; ++k) {
    // The line through two corners, as a plane of rays: n = (K R)^T line.
    Eigen::Vector3d line = corners[k].homogeneous().cross(corners[(k + 1) % 4].homogeneous());
    if (line.dot(middle) < 0) line = -line;
    sides[k] = (pixelFromWorld.transpose() * line).normalized();
  }
  return sides;
}

}  // namespace glint
