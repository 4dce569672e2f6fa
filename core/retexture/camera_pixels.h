// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <string>

#include "core/base/progress.h"
#include "core/geometry/camera.h"
#include "core/surface/surface.h"

namespace glint {

/// Calls work(i, ideal) for each measured pixel of a camera, row by row: i its place in the camera's image, ideal the pixel
/// without distortion. Skips pixels that the lens cannot undistort. Rows run in several threads (core/base/parallel.h).
void forEachPixel(const Camera& camera, const std::function<void(std::size_t i, const Pixel& ideal)>& work,
                  const ProgressFn& progress, const std::string& stage);

/// The same for pixels that show the surface: work(i, p), p the point with its normal towards the camera.
void forEachSurfacePixel(const Camera& camera, const Surface& surface,
                         const std::function<void(std::size_t i, const SurfacePoint& p)>& work, const ProgressFn& progress,
                         const std::string& stage);

}  // namespace glint
