// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "core/geometry/camera.h"
#include "core/geometry/plane.h"
#include "viz/scene_view.h"

class vtkCamera;
class vtkRenderer;

namespace glint::viz {

/// A picture and the part of it that a renderer draws, window px. Where two renderers share one picture (the wipe), each draws
/// its own columns of it.
struct PictureArea {
  int width = 1, height = 1;  ///< of the whole picture
  int left = 0, right = 1;    ///< columns of this part: [left, right)
};

/// Where the ideal pixels of a photograph lie in the picture.
struct PhotographPlacement {
  double scale = 1;               ///< window px per photograph px
  Eigen::Vector2d topLeft{0, 0};  ///< of the photograph's top left corner (ideal pixel (-0.5, -0.5)); window px, y up
  /// Window px, y up, (0, 0) = lower left corner of the picture's lower left pixel.
  Eigen::Vector2d at(const Pixel& ideal) const {
    return {topLeft.x() + scale * (ideal.x() + 0.5), topLeft.y() - scale * (ideal.y() + 0.5)};
  }
};
/// The largest picture of the whole photograph in the middle, enlarged by `zoom` about the middle and then moved by `shift`
/// (window px, y up).
PhotographPlacement placePhotograph(const Camera& camera, const PictureArea& area, double zoom, const Eigen::Vector2d& shift);

/// Stands a VTK camera at a camera (or, with a mirror, at its virtual camera P M) so that a world point X is drawn exactly where
/// the placement puts the ideal pixel of P X (of P M X): principal point, unequal focal lengths and skew are honoured through
/// the camera's user transform. The mirrored one is left-handed: it flips the picture, so front faces turn into back faces.
/// @param focalDistance  > 0, world units; only what VTK measures from the focal point depends on it.
void standAt(vtkCamera* vtk, const Camera& camera, const std::optional<Plane>& mirror, const PhotographPlacement& placement,
             const PictureArea& area, double focalDistance);
/// The same for a free camera: only the part of the picture is taken into account.
void standFree(vtkCamera* vtk, const PictureArea& area);

/// Poses a VTK camera. In a parallel view the visible height is that of a perspective one at the focal point.
void setViewPoint(vtkCamera* vtk, const ViewPoint& view);
ViewPoint viewPointOf(vtkCamera* vtk);

/// A view on the way from one to another: the focal point moves straight, the distance to it by equal ratios, and the eye turns
/// about it the short way, upwards kept upwards. @param t  0 = from, 1 = to (exactly).
ViewPoint between(const ViewPoint& from, const ViewPoint& to, double t);

/// Moves points towards the eye along their rays of sight, by as much as `px` pixels measure where they are: in the picture
/// they stay where they were, nearer than what they lie on. @param heightPx  of the picture, > 0.
Eigen::Affine3d nearer(vtkCamera* vtk, double px, int heightPx);

/// World point under a window px (device px, y up), as far from the eye as `anchor`: where a dragged thing goes.
Eigen::Vector3d worldAt(vtkRenderer* renderer, double xDisplay, double yDisplay, const Eigen::Vector3d& anchor);

/// Share of each half of the picture that a fitted view may use, 0..1.
struct Margins {
  double left = 0.92, right = 0.92, top = 0.92, bottom = 0.92;
};
/// Margins that avoid a legend in the upper left corner (beside it or below it, whichever leaves more) and a bar at the bottom.
/// @param legendPx  width and height. @param barPx  height, 0 = none.
Margins marginsBeside(const Eigen::Vector2d& legendPx, double barPx, const PictureArea& whole);
/// The closest view along -`back` that holds all points (at least one) between the margins.
/// @param back, up  unit, square to each other. @param aspect  width / height. @param reference  the focal point's depth.
ViewPoint fitted(const std::vector<Eigen::Vector3d>& points, const Eigen::Vector3d& back, const Eigen::Vector3d& up,
                 double aspect, const Margins& margins, bool parallel, const Eigen::Vector3d& reference, double leastDepth);

/// Direction from the scene towards the eye of an axis view, and its upward direction, where the world's upward axis is `up`
/// (a signed unit axis). Front is from -y in a world whose z is up, from +z in one whose y is up.
struct AxisDirections {
  Eigen::Vector3d back, up;
};
AxisDirections axisDirections(AxisView view, const Eigen::Vector3d& up);

}  // namespace glint::viz
