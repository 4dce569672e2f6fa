// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "core/base/outcome.h"
#include "core/geometry/ellipsoid.h"
#include "core/geometry/plane.h"

namespace glint {

/// A plane through a centre of projection that touches the cone from there through an ellipse.
struct ConePlane {
  Plane plane;            ///< world; the normal points away from the cone's inside
  Eigen::Vector3d along;  ///< unit, from the centre of projection along the line in which plane and cone touch
  Pixel contact;          ///< where that line meets the image, ideal px
};

/// Tangent planes of the cone through an ellipse, pi = P^T l with l = C x the tangent of the ellipse at x, at n equal steps of
/// the ellipse's parameter.
/// @param projection  pixels from world, real or mirrored, with a finite centre; depth in front is positive.
/// @param n  >= 3.
/// @return  RankDeficient for a projection whose centre is at infinity; NotFinite.
/// @see Hartley & Zisserman, Multiple View Geometry, 2nd ed., result 8.2 (the plane of a line).
Outcome<std::vector<ConePlane>> conePlanes(const Projection& projection, const Ellipse& ellipse, int n);

/// The centre of projection, P C = 0. RankDeficient if it lies at infinity.
Outcome<Eigen::Vector3d> centreOf(const Projection& projection);

/// Polar reciprocity in a sphere: a chart of the dual space, in which planes are points. The plane n.(X - centre) = h becomes the
/// point radius^2 n / h, in metres from the centre of the chart: the farther the plane, the nearer its point.
struct Reciprocal {
  Eigen::Vector3d centre{0, 0, 0};
  double radius = 1;  ///< m, > 0
};

/// The dual point of a plane, in the chart's own coordinates. RankDeficient if the plane goes through the chart's centre to
/// round-off: its point lies at infinity.
Outcome<Eigen::Vector3d> dualPoint(const Plane& plane, const Reciprocal& chart);

/// The dual quadric of an ellipsoid in the chart: where the dual points of its tangent planes lie. About its centre it is the
/// ellipsoid with the same axes and semi-axes radius^2 / a. With centre c (seen from the chart's) and shape S:
/// y^T (S - c c^T) y + 2 radius^2 c.y = radius^4.
/// NotAnEllipsoid if the chart's centre lies outside of the ellipsoid or on it, or if the ellipsoid is flat.
/// @see Coxeter, The Real Projective Plane, ch. 8 (polarity); Hartley & Zisserman, 2nd ed., sec. 3.2.3 (dual quadrics).
Outcome<Ellipsoid> reciprocal(const Ellipsoid& ellipsoid, const Reciprocal& chart);

}  // namespace glint
