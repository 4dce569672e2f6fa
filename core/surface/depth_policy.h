// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <compare>

namespace glint {

/// How measured depth is smoothed before it becomes a surface.
/// None: as measured. Bilateral: weighted mean of inverse depths, near in the image and alike in depth (OpenCV). Fit: quadratic
/// in inverse depth, fitted to the neighbours on the same surface; it gives the normal as well.
enum class DepthSmoothing { None, Bilateral, Fit };
/// Plane: fitted to the neighbours within a radius (PCL). Integral: from integral images of the covariance, over a square of
/// pixels of that size (PCL).
enum class DepthNormals { Plane, Integral };

/// How a depth map becomes a surface. The defaults suit depth without noise.
struct DepthPolicy {
  DepthSmoothing smoothing = DepthSmoothing::None;
  DepthNormals normals = DepthNormals::Plane;
  /// Radius, m, of the neighbourhood that gives a point its normal and its smoothed depth; 0 = a share of the median depth.
  double radius = 0;
  int largestHolePx = 400;  ///< holes of at most this many pixels that touch no image border are filled; 0 = none
  int fusedFrames = 0;      ///< other frames whose depth is averaged in, where the object stands still
  double noise = 0;         ///< trials only: noise like that of a first Kinect is added, times this
  int seed = 1;             ///< of that noise

  auto operator<=>(const DepthPolicy&) const = default;
};

}  // namespace glint
