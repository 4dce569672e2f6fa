// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/geometry/conic.h"

namespace glint {

/// The foot of a point on an ellipse.
struct EllipseFoot {
  double distance;  ///< px, signed: positive outside
  Pixel point;      ///< nearest point of the ellipse
  Pixel normal;     ///< outward unit normal there
};

/// Nearest point of an ellipse, to round-off for any finite pixel: the root of a convex function, reached by Newton's method from
/// the side where it cannot overshoot. @see Eberly, Distance from a Point to an Ellipse, an Ellipsoid, or a Hyperellipsoid, 2013.
EllipseFoot footOnEllipse(const Ellipse& ellipse, const Pixel& p);

}  // namespace glint
