// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "core/base/image.h"
#include "core/base/outcome.h"
#include "core/base/progress.h"
#include "core/geometry/camera.h"
#include "core/geometry/light.h"
#include "core/surface/surface.h"

namespace glint {

/// A frame's pixels as they count for its shading, all of the camera's size.
struct ShadedFrame {
  const Image& linear;              ///< 3 channels
  const Image& highlight;           ///< 3 channels, what the highlights add; taken off
  const std::vector<char>& usable;  ///< per pixel: unclipped, on the glossy object
};

/// How a matt surface of one albedo would look in a frame: shade(u) = a + sum over lights b_l max(0, N.L) / r^2 (0 in shadow),
/// mean of the channels, a and b_l >= 0 fitted to the frame. The albedo is part of a and b: lighting alone does not tell it.
struct LambertShading {
  Image shade;                  ///< one channel, linear; 0 off the surface
  std::vector<char> onSurface;  ///< per pixel
  double ambient = 0;           ///< a
  std::vector<double> byLight;  ///< b_l, at the mean of N.L / r^2 over the frame
  double relativeRms = 0;       ///< of what the frame's pixels differ from it, as a share of their mean
};

/// @param lights  estimated ones, at least one.
/// NoSurface if no pixel shows the surface; TooFewPoints if too few are left beside highlights; NotFinite. Stopped.
Outcome<LambertShading> fitLambert(const Surface& surface, const Camera& camera, const std::vector<Light>& lights,
                                   const ShadedFrame& frame, const ProgressFn& progress = {});

}  // namespace glint
