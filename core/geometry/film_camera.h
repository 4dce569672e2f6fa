// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/geometry/camera.h"

namespace glint {

/// A camera from a photograph's focal length on 35 mm film: the same angle of view across the diagonal (CIPA DC-008, tag 0xA405),
/// square pixels, central principal point, no distortion. Good to a few percent: EXIF rounds to millimetres, and lenses distort.
/// @param mm  above 0
inline Camera filmCamera(double mm, int width, int height) {
  constexpr double kFilmDiagonal = 43.2666;  // mm, of 36 x 24
  Camera camera;
  camera.width = width;
  camera.height = height;
  const double px = mm / kFilmDiagonal * Eigen::Vector2d(width, height).norm();
  camera.pixelFromRay << px, 0, (width - 1) / 2.0, 0, px, (height - 1) / 2.0, 0, 0, 1;
  return camera;
}

}  // namespace glint
