// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Pixels of a camera and of its photograph.
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/geometry/camera.h"
#include "core/pipeline/inspection.h"
#include "core/surface/surface.h"

namespace glint {

/// Calls work(i, ideal) for each measured pixel of a camera, row by row: i its place in the camera's image, ideal the pixel
/// without distortion. Skips pixels that the lens cannot undistort. Rows run in several threads (core/base/progress.h).
void forEachPixel(const Camera& camera, const std::function<void(std::size_t i, const Pixel& ideal)>& work,
                  const ProgressFn& progress, const std::string& stage);

/// The same for pixels that show the surface: work(i, p), p the point with its normal towards the camera.
void forEachSurfacePixel(const Camera& camera, const Surface& surface,
                         const std::function<void(std::size_t i, const SurfacePoint& p)>& work, const ProgressFn& progress,
                         const std::string& stage);

/// A frame's photograph in linear light, as retexturing needs it.
struct FramePixels {
  Image linear;              ///< 3 channels, 1 = the largest code
  std::vector<char> glossy;  ///< per pixel: on the glossy object as the frame's mask has it; 1 without a mask
  std::vector<char> usable;  ///< per pixel: glossy, finite, clipped in no channel
};

/// NotSupported for a frame with radiance alone: nothing tells how bright a picture shows it. FrameUnreadable.
Outcome<FramePixels> framePixels(const Inspection& inspection, int frame);

}  // namespace glint
