// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "viz/scene_view.h"

namespace glint::viz {

/// The view nearer by `factor` (> 0; below 1: farther), so that the point stays where it is in the picture: zooming to the
/// pointer. In a parallel view the visible height changes instead.
ViewPoint zoomedAbout(const ViewPoint& view, const Eigen::Vector3d& point, double factor);

/// The view turned about a point, which stays where it is in the picture: `sideways` about the view's upwards (positive: the
/// scene turns to the right), then `upwards` about its right (positive: its near side turns upwards), radians.
ViewPoint turnedAbout(const ViewPoint& view, const Eigen::Vector3d& point, double sideways, double upwards);

}  // namespace glint::viz
