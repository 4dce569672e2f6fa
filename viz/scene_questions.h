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
/// What a view must hold, and from where.
struct Framing {
  std::vector<Eigen::Vector3d> points;
  Eigen::Vector3d back{0, 0, 1}, up{0, 1, 0};  ///< unit, square to each other; back: towards the eye
  Eigen::Vector3d reference{0, 0, 0};          ///< the focal point's depth
  double leastDepth = 0;
};
/// Other drawn parts that the view must hold.
struct DrawnParts {
  bool normal = false, ellipsoids = false, virtualCameras = false, tangentPlanes = false, walk = false;
};
DrawnParts drawnParts(const SceneView& view);
/// A highlight of the selected frame.
/// @param highlight  index in the frame's evidence; out of range = the first. Nothing if it is not on the surface.
std::optional<Framing> highlightFraming(const LayerInput& in, int highlight, HighlightLook look, const DrawnParts& drawn);
/// What the cones of a model hold: the brightest points of the views that it was made from and the ellipsoids, across their
/// longest extent, as far as an ellipsoid that is small among them can be seen along with them.
/// @param model  "" = all. @param frames  not empty.
std::optional<Framing> ellipsoidFraming(const LayerInput& in, const std::vector<int>& frames, const std::string& model);
/// The world's upward direction as the cameras have it; a signed axis where it is near one. @param frames  not empty.
Eigen::Vector3d upwards(const LayerInput& in, const std::vector<int>& frames);
/// Unit direction from the scene towards an eye that sees the highlights before the surface and the frustums.
Eigen::Vector3d overviewDirection(const LayerInput& in, const std::vector<int>& frames, const Eigen::Vector3d& up);

/// Numbers of a surface point, for the selected frame's camera.
Picked surfaceInfo(const LayerInput& in, const SurfacePoint& hit);
/// A picked point of a contour is a direction from the observed one: fills Picked::direction.
void addDirection(const LayerInput& in, Picked& picked);

/// What a drawn camera tells: its frame, and its numbers.
Picked cameraPicked(const Inspection& inspection, const std::vector<std::string>& models, int frame);
/// The nearest drawn camera whose frustum, taken as solid, lies under a window pixel (y up).
std::optional<Picked> cameraUnder(vtkRenderer* renderer, const LayerInput& in, int xDisplay, int yDisplay);

/// What lies under a window pixel (y up): the surface exactly, everything else by its actors, and what lies on the surface before
/// the surface itself. @param drawn  of the visible layers. @param surfaceShown  through a virtual camera it is not asked.
std::optional<Picked> pickIn(vtkRenderer* renderer, const LayerInput& in, const std::vector<const Drawn*>& drawn,
                             bool surfaceShown, int xDisplay, int yDisplay);

/// While looking through a camera: whether the glyph of another one begins beside or behind the eye. Its lines and its photograph
/// would run across the whole picture, so neither is drawn. False from outside.
bool besideEye(const LayerInput& in, int frame);

}  // namespace glint::viz
