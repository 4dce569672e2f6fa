// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "core/geometry/light.h"
#include "core/surface/surface.h"

namespace glint {

/// A place where the highlight of one light is brightest, with the normal on the camera's side.
struct BrightestPoint {
  SurfacePoint point;  ///< normal faces the camera
  Pixel pixel;         ///< its ideal pixel
  double alpha = 0;    ///< remaining incident angle, rad (0 to round-off for a predicted point on a smooth surface)
};

/// Observed: the ray through the measured peak (ideal pixels) hits the surface. PeakOffSurface. method.md section 3.
Outcome<BrightestPoint> observedBrightestPoint(const Surface& surface, const Camera& camera, const Pixel& peak);

struct BrightestPointOptions {
  double seedStepPx = 16;       ///< spacing of the coarse ray grid that seeds the search
  double marginFraction = 0.1;  ///< the grid reaches this far beyond the image, as a fraction of its size
  int maxIterations = 50;
  /// World points tried first (last frame's answers); when `hintsOnly` nothing else is tried.
  std::vector<Eigen::Vector3d> hints;
  bool hintsOnly = false;
};

/// Predicted: all visible and lit surface points where the reflection law holds (both tangential components of H
/// vanish), sorted by alpha, then by distance from the image centre;
/// each is polished by Newton's method until the step no longer shrinks.
/// NoBrightestPoint (detail says why: not visible, not lit, off the surface, no stationary point). method.md section 3.
Outcome<std::vector<BrightestPoint>> predictedBrightestPoints(const Surface& surface, const Camera& camera, const Light& light,
                                                              const BrightestPointOptions& options = {});

}  // namespace glint
