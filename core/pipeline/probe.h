// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/pipeline/inspection.h"

namespace glint {

/// What lies under a pixel of a photograph.
struct PixelProbe {
  SurfacePoint point;  ///< first hit of the pixel's ray, N on the camera's side
  double depth = 0;    ///< along the optical axis, m
  struct Incidence {
    std::string light;
    std::optional<double> alpha;  ///< angle(N, H), rad; nothing if the light is behind the surface
  };
  std::vector<Incidence> lights;  ///< the estimated lights that may shine on this frame, by id
};

/// Surface and incident angles at a pixel of a frame. The surface is the scene's (without light.refine_depth and
/// light.refine_normals). May load a frame's own depth map, which takes its time.
/// @param measured  photograph pixel, as in the file (lens distortion not removed).
/// @return  NoHit where the ray misses; NoSurface, FrameUnreadable of the surface; the reason of a pixel beyond the lens model.
///          std::invalid_argument for a frame that does not exist.
Outcome<PixelProbe> probePixel(const Inspection& inspection, int frame, const Pixel& measured);

}  // namespace glint
