// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "core/base/image.h"
#include "core/base/outcome.h"

namespace glint {

/// How blurred a frame is at most, by its sharpest edges (without sharp things a frame looks blurred): defocus, equal in all
/// directions, and motion along one. Variance along t: sigma0^2 + (length cos(t - direction))^2 / 12; a sharp lens has 0.
struct FrameBlur {
  double sigmaPx = 0;       ///< standard deviation across the motion
  double motionPx = 0;      ///< length of the path during the exposure; 0 where none shows
  double directionRad = 0;  ///< of the motion, 0 = right, pi/2 = down, in [0, pi); meaningless without motion
  int edges = 0;            ///< profiles that were measured

  double varianceAlong(double rad) const;  ///< px^2
};

/// Measures step edges: along the gradient, the variance of its derivative, less that of interpolation and of a pixel. The
/// lower quartile of each of eight directions counts (soft shading is no blur); a fit of three coefficients over the directions
/// separates motion from the rest. Tells motion only if six directions follow the fit well; else the sharpest direction counts.
/// This is the blur of edges. A moving object before a still wall is more blurred. A matt object whose silhouette fades
/// into a dark ground is less: rendered ellipsoids without blur gave up to 2.6 px, at times a motion of 12 px. Callers say so.
/// @param image    1 or 3 channels, linear. @param clipValue  leaves out edges that touch values at or above it; 0 = none
/// @return  TooFewPoints if fewer than four directions have enough edges: then neither direction nor size of a blur is known.
/// @see Couzinie-Devy, Sun, Alahari and Ponce, Learning to estimate and remove non-uniform image blur, CVPR 2013 (local edges).
Outcome<FrameBlur> measureBlur(const Image& image, double clipValue);

/// Standard deviation of pixel noise from the median response of a second-difference mask, blind to smooth shading.
/// @param image  one channel. @param usable  one per pixel; places that are not count nothing
/// @see Immerkaer, Fast noise variance estimation, CVIU 1996 (the mask; the median instead of the mean is for edges).
double pixelNoise(const Image& image, const std::vector<char>& usable);

}  // namespace glint
