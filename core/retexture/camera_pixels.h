// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <string>

#include "core/base/progress.h"
#include "core/geometry/camera.h"
#include "core/surface/surface.h"

namespace glint {

/// Calls work(i, ideal) for each measured pixel of a camera: i its place in an image of the camera's size, row by row, ideal the pixel without
/// distortion. Pixels that the lens model cannot undistort are passed over. Rows run in several threads (core/base/parallel.h, what it throws).
void forEachPixel(const Camera& camera, const std::function<void(std::size_t i, const Pixel& ideal)>& work,
                  const ProgressFn& progress, const std::string& stage);

/// The same for pixels that show the surface: work(i, p), p the point with its normal towards the camera.
void forEachSurfacePixel(const Camera& camera, const Surface& surface,
                         const std::function<void(std::size_t i, const SurfacePoint& p)>& work, const ProgressFn& progress,
                         const std::string& stage);

}  // namespace glint
