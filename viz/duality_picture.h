// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/advise/duality.h"
#include "viz/drawn_picture.h"

namespace glint::viz {

/// One plane of one cone, as indices of Duality::views and View::planes.
struct DualityPlane {
  int view = -1, plane = -1;
  friend bool operator==(const DualityPlane&, const DualityPlane&) = default;
};

/// Both panes are seen from the same side, so that a plane's normal and the direction of its dual point are parallel on screen.
struct DualityLook {
  double turn = 0, tilt = 0;  ///< rad, from the first look: the mean cone comes from the side
  int frame = -1;             ///< its view is drawn stronger; none of the views = the first
  DualityPlane lit;           ///< this plane and its point are; view -1 = none
  double width = 0, height = 0, textPx = 12;
  bool dark = true;
};

/// The picture, and where its planes and points are for a pointer.
struct DualityPicture {
  struct Place {
    Eigen::Vector2d at;
    DualityPlane plane;
  };
  DrawnPicture drawn;
  std::vector<Place> planes, points;  ///< of the left and the right pane
  int outside = 0;                    ///< dual points that are beyond their pane's edge, which cannot be drawn in their place
};

/// Left (or above, where the picture is higher than wide) the ellipsoid, its cones and their tangent planes; right their dual
/// points on the dual quadric.
DualityPicture dualityPicture(const Duality& duality, const DualityLook& look);

/// The plane under the pointer: the nearest plane or point within `reach` px.
std::optional<DualityPlane> planeAt(const DualityPicture& picture, const Eigen::Vector2d& at, double reach = 14);

/// The plane of a frame's cones that touches its cone nearest to a place, as seen from the cone's apex. Nothing if no cone is
/// of that frame, or where the place is the apex.
/// @param place  world, m
std::optional<DualityPlane> planeNearest(const Duality& duality, int frame, const Eigen::Vector3d& place);

/// Two sentences about the lit plane, or how planes and points hang together. Plain text.
/// @param frameId  of the lit plane's view, or of the one that is drawn stronger.
std::string dualityWords(const Duality& duality, const DualityPlane& lit, const std::string& frameId);

}  // namespace glint::viz
