// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "core/base/image.h"
#include "core/base/outcome.h"
#include "core/geometry/camera.h"
#include "core/surface/surface.h"

namespace glint {

struct DepthMapOptions {
  /// Neighbours that give a point its normal lie within this share of the median depth: the paper's 3 cm at 2 m.
  double normalRadius = 0.015;
  int largestHolePx = 400;     ///< holes of at most this many pixels that touch no image border are filled (Telea)
  double inpaintRadiusPx = 3;  ///< neighbourhood of the filling
  double jump = 0.05;          ///< relative depth difference between neighbours that cuts the surface
  MeshPolicy mesh;
};

/// Surface of one depth map: fill small holes, unproject every pixel, normals from neighbours within a radius (plane fit,
/// oriented towards the camera), two triangles per pixel cell, cut where depth jumps. method.md section 2.
///
/// @param depthMetres  one channel, metres along the optical axis; not finite or <= 0 = none.
/// @param camera       of the same size; its lens distortion is removed from the pixels.
/// @return NoSurface when fewer than one cell of pixels has a depth. std::invalid_argument for another size than the
///         camera's, more than one channel, or options that are not positive.
/// @see Telea, An Image Inpainting Technique Based on the Fast Marching Method, 2004 (OpenCV photo); PCL features.
Outcome<std::shared_ptr<const Surface>> makeDepthMap(const Image& depthMetres, const Camera& camera,
                                                     const DepthMapOptions& options = {});

}  // namespace glint
