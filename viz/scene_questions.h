// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "viz/layers.h"

namespace glint::viz {

/// What the 3D view asks about the scene that it shows: where things are, and what lies under the mouse. World units.

/// Centre and image corners of a drawn camera.
void addFrustum(const LayerInput& in, std::vector<Eigen::Vector3d>& points, int frame);
/// The selected highlight on the surface, else the selected model's ellipsoids, else the selected camera with its highlights;
/// never empty.
std::vector<Eigen::Vector3d> selectedExtent(const LayerInput& in);
/// Where a highlight of the selected frame lies on the surface.
struct HighlightPlace {
  std::vector<Eigen::Vector3d> points;  ///< brightest point first, then its contour, the ends of its walks, the tip of a normal
  Eigen::Vector3d normal{0, 0, 1};      ///< at the brightest point, towards the camera; unit
  Eigen::Vector3d back{0, 0, 1};        ///< from there to an eye that sees T and what lies under it; unit
  double radius = 0;
};
/// @param highlight  index in the frame's evidence; out of range = the first. Nothing where it is not on the surface.
std::optional<HighlightPlace> highlightPlace(const LayerInput& in, int highlight);
/// What the cones of a model hold: the brightest points of the views on this surface and the ellipsoids; empty where there is
/// none.
std::vector<Eigen::Vector3d> ellipsoidExtent(const LayerInput& in, const std::string& model);
/// A direction as near to `towards` as is square to the longest extent of the points, so that it is not seen end on; unit.
Eigen::Vector3d sideDirection(const std::vector<Eigen::Vector3d>& points, const Eigen::Vector3d& up,
                              const Eigen::Vector3d& towards);
/// The world's upward direction as the cameras have it; a signed axis where it is near one. @param frames  not empty.
Eigen::Vector3d upwards(const LayerInput& in, const std::vector<int>& frames);
/// From the scene towards an eye that sees the highlights with neither the surface nor the frustums before them; unit.
Eigen::Vector3d overviewDirection(const LayerInput& in, const std::vector<int>& frames, const Eigen::Vector3d& up);

/// Numbers of a surface point, for the selected frame's camera.
Picked surfaceInfo(const LayerInput& in, const SurfacePoint& hit);
/// A picked point of a contour is a direction from the observed one: fills Picked::direction.
void addDirection(const LayerInput& in, Picked& picked);

/// What lies under a window pixel (y up): the surface exactly, everything else by its actors, and what lies on the surface before
/// the surface itself. @param drawn  of the visible layers. @param surfaceShown  through a virtual camera it is not asked.
std::optional<Picked> pickIn(vtkRenderer* renderer, const LayerInput& in, const std::vector<const Drawn*>& drawn,
                             bool surfaceShown, int xDisplay, int yDisplay);

}  // namespace glint::viz
