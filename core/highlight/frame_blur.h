// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "core/base/image.h"
#include "core/base/outcome.h"

namespace glint {

/// How blurred a frame is at most, from its sharpest edges (a frame in which nothing is sharp looks the same as a blurred one): defocus and the like, equal in all directions, and motion along one. Along a direction t the
/// variance is sigma0^2 + (length cos(t - direction))^2 / 12. What a sharp lens and square pixels would show counts as no blur.
struct FrameBlur {
  double sigmaPx = 0;       ///< standard deviation across the motion
  double motionPx = 0;      ///< length of the path during the exposure; 0 where none shows
  double directionRad = 0;  ///< of the motion, 0 = right, pi/2 = down, in [0, pi); meaningless without motion
  int edges = 0;            ///< profiles that were measured

  double varianceAlong(double rad) const;  ///< px^2
};

/// Measures step edges: along the gradient, the variance of the profile's derivative, less that of the interpolation and of a pixel. In each of eight
/// directions the lower quartile counts, because soft shading is no blur; a fit of three coefficients over the directions parts motion from the rest. Motion is
/// told only where six directions follow the fit well; else the sharpest direction is the answer.
/// It is the blur of what has edges: a moving object before a still wall is more blurred than this says, and of a matt object before a dark ground, whose
/// silhouette fades, this says too much: rendered ellipsoids without any blur gave up to 2.6 px and now and then a motion of 12 px. Callers say so.
/// @param image    1 or 3 channels, linear. @param clipValue  edges that touch values at or above it are left out; 0 = none
/// @return  TooFewPoints where fewer than four directions have edges enough; the direction of a blur is then not known, nor its size.
/// @see Couzinie-Devy, Sun, Alahari and Ponce, Learning to estimate and remove non-uniform image blur, CVPR 2013 (the idea of local edges).
Outcome<FrameBlur> measureBlur(const Image& image, double clipValue);

}  // namespace glint
