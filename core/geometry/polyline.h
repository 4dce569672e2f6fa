// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "core/geometry/camera.h"

namespace glint {

/// An ordered chain of pixels. When `closed`, the last point joins the first (which is not repeated).
struct Polyline {
  std::vector<Pixel> points;
  bool closed = true;
};

double length(const Polyline& line);      ///< px, includes the closing segment
double signedArea(const Polyline& line);  ///< px^2, shoelace, open lines are closed first; positive when clockwise on screen
Pixel centroid(const Polyline& line);     ///< area centroid; mean of the points when the area vanishes
bool contains(const Polyline& line, const Pixel& p);    ///< even-odd rule; boundary points either way
double distance(const Polyline& line, const Pixel& p);  ///< px to the nearest point of the chain; infinity when empty
/// Farthest crossing of the half line from `origin` in `direction` (rad, 0 = right, pi/2 = down) with the chain, px; nothing
/// when they do not meet. The farthest, because on a contour that folds back the outer side is the one that is seen.
std::optional<double> reach(const Polyline& line, const Pixel& origin, double direction);
/// n points equally spaced in arc length, first at the first point. Needs >= 1 point.
std::vector<Pixel> resample(const Polyline& line, int n);
/// Its own points nearest to those of `resample`: at most n, in order, none twice. As exact as the points, unlike the chords.
std::vector<Pixel> thinned(const Polyline& line, int n);
/// Consecutive repeated points (closer than `tolerancePx`) removed.
Polyline withoutRepeats(const Polyline& line, double tolerancePx = 1e-9);

/// Whether a contour runs along the border of the photograph over more than two pixels: the border cuts it (alongImageBorder()).
bool runsAlongImageBorder(const Camera& camera, const Polyline& line);

/// The part of a closed polyline inside a box; empty if none is (Sutherland, Hodgman, Reentrant polygon clipping, CACM 1974).
/// One that leaves the box and comes back stays one: its parts are joined along the border by segments that enclose nothing, so
/// that the signed area and the even-odd interior are those of the intersection. Points inside stay as they are.
/// @param closed  finite
Polyline clippedTo(const Eigen::AlignedBox2d& box, const Polyline& closed);

}  // namespace glint
