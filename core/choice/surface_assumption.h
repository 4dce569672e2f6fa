// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include "core/geometry/camera.h"
#include "core/geometry/polyline.h"
#include "core/surface/surface.h"

namespace glint {

/// A highlight on a surface, observed or predicted.
struct HighlightOnSurface {
  Camera camera;
  std::shared_ptr<const Surface> surface;
  Polyline contour;  ///< ideal pixels
};

/// What the surface under some highlights says about models that assume its shape, as shares of the limit angle, which is what
/// moves a contour. Curvatures are means over a highlight, from the normals at its contour: that serves facets too, and bumps
/// much smaller than the highlight cancel.
struct SurfaceShape {
  /// How far the surface is from one plane: largest t / (t + psi/2) over the highlights, t the angle by which the normal turns
  /// over the highlight (curvature times extent) or away from the common normal, psi the highlight's angular radius: psi/2 is
  /// what a plane adds to alpha under a far light. Also the distance from the common plane over the highlight's radius. In [0,
  /// 1].
  double bend = 0;
  /// How far principal curvatures differ between the highlights: largest |k - mean k| / (max |mean k| + 1 / 2D), D the distance
  /// of the camera. 0 on planes, spheres and cylinders.
  double curvatureChange = 0;
  int highlights = 0;  ///< looked at; those with fewer than six contour points on the surface are not
};

SurfaceShape surfaceShape(const std::vector<HighlightOnSurface>& highlights);

/// Moving a normal by a share b of the limit angle moves the contour by b of its radius: a mean distance of b / pi of its
/// diameter. Up to here (0.05 % of the diameter) the surface is a plane as far as contours resolve.
inline constexpr double kPlaneBend = 0.0016;
/// Beyond (0.6 %) it is no plane, whatever residuals say.
inline constexpr double kNoPlaneBend = 0.02;
/// Beyond, the curvature is not constant: `dual` predicts a highlight's size from it.
inline constexpr double kNotConstantCurvature = 0.2;

}  // namespace glint
