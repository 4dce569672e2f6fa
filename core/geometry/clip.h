// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>

#include "core/geometry/polyline.h"

namespace glint {

/// The part of a closed polyline inside a box; empty if none is (Sutherland, Hodgman, Reentrant polygon clipping, CACM 1974).
/// One that leaves the box and comes back stays one: its parts are joined along the border by segments that enclose nothing, so
/// that the signed area and the even-odd interior are those of the intersection. Points inside stay as they are.
/// @param closed  finite
Polyline clippedTo(const Eigen::AlignedBox2d& box, const Polyline& closed);

}  // namespace glint
