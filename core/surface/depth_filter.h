// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/base/image.h"
#include "core/geometry/camera.h"

namespace glint {

/// Depth with less noise, and the normals that came with it.
struct SmoothDepth {
  Image depth;  ///< m, 0 = none; the same pixels as before have depth
  /// Camera frame, towards the camera, unit, one per pixel; 0 where too few neighbours determine one. Empty where the method
  /// gives none.
  std::vector<Eigen::Vector3d> normals;
};

/// Median of the depths; 1 without any depth.
double medianDepth(const Image& depth);

/// Weighted means of inverse depths, Gaussian in the image and in depth (OpenCV's bilateral filter): edges stay where they are.
/// @param depth   one channel, m; 0 = none.
/// @param radius  m, above 0: two standard deviations of both weights at the median depth.
/// @see Tomasi and Manduchi, Bilateral Filtering for Gray and Color Images, ICCV 1998.
SmoothDepth bilateralDepth(const Image& depth, const Camera& camera, double radius);

/// At every pixel the quadratic polynomial in image coordinates that fits the inverse depths of its neighbours best; its value is
/// the depth, its slope the normal. The inverse depth of a plane is linear in the image, and the noise of a stereo device is the
/// same everywhere, so that this has no error on planes and equal weights are right. Neighbours lie within a ball about the
/// pixel's point, on the same side of every jump of the depth; weights fall as (1 - d^2/r^2)^2.
/// @param depth   one channel, m; 0 = none.
/// @param radius  m, above 0, of the ball. Where a ball has fewer pixels than determine a polynomial it is linear, and where
///                fewer still the depth stays as it is, without a normal.
/// @see Cleveland and Devlin, Locally Weighted Regression, JASA 1988.
SmoothDepth fittedDepth(const Image& depth, const Camera& camera, double radius);

}  // namespace glint
