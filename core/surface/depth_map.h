// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include "core/base/image.h"
#include "core/base/outcome.h"
#include "core/geometry/camera.h"
#include "core/surface/surface.h"

namespace glint {

struct DepthMapOptions {
  /// Neighbours that give a point its normal lie within this share of the median depth: the paper's 3 cm at 2 m.
  /// `mesh.depth.radius` replaces it.
  double normalRadius = 0.015;
  double inpaintRadiusPx = 3;  ///< neighbourhood of the filling
  double jump = 0.05;          ///< relative depth difference between neighbours that cuts the surface
  MeshPolicy mesh;             ///< with the treatment of depth
};

/// Depth with small holes filled.
struct FilledDepth {
  Image depth;               ///< m, 0 = none
  std::vector<char> filled;  ///< one per pixel: 1 = not measured; empty when nothing was filled
};

/// Fills holes of at most `largestHolePx` pixels that touch no image border.
/// @param depth  one channel, m; not finite or <= 0 = none.
/// @see Telea, An Image Inpainting Technique Based on the Fast Marching Method, 2004 (OpenCV photo).
FilledDepth withoutSmallHoles(const Image& depth, int largestHolePx, double inpaintRadiusPx = DepthMapOptions().inpaintRadiusPx);

/// Surface of one depth map: fill small holes, smooth if asked, unproject every pixel, normals from neighbours within a radius
/// (plane fit, oriented towards the camera), two triangles per pixel cell, cut where depth jumps. method.md section 2. The
/// surface is a FilledParts.
///
/// @param depthMetres  one channel, metres along the optical axis; not finite or <= 0 = none.
/// @param camera       of the same size; its lens distortion is removed from the pixels.
/// @return NoSurface when fewer than one cell of pixels has a depth. std::invalid_argument for another size than the
///         camera's, more than one channel, or options that are not positive.
/// @see PCL features: NormalEstimation; Holzer et al., Adaptive Neighborhood Selection for Real-Time Surface Normal Estimation
///      from Organized Point Cloud Data Using Integral Images, IROS 2012.
Outcome<std::shared_ptr<const Surface>> makeDepthMap(const Image& depthMetres, const Camera& camera,
                                                     const DepthMapOptions& options = {});

}  // namespace glint
