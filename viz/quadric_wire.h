// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "core/geometry/ellipsoid.h"
#include "viz/convert.h"

namespace glint::viz {

/// A wire picture of the surface of any dual quadric Q*.
struct QuadricWire {
  std::string kind;                 ///< as describe() of the core: "hyperboloid of two sheets"
  std::vector<Points> curves;       ///< on the surface, cut at the region's circumscribed sphere; world units
  std::vector<Segment> axes;        ///< of an imaginary quadric or a point, which has no surface: its centre and axes
  Eigen::Vector3d anchor{0, 0, 0};  ///< place of its label: on the curves, else at the centre, else the region's centre
};

/// Hyperboloids, paraboloids, flat conics and segments are real and drawn as curves; imaginary quadrics and points as the cross
/// of their axes (at least a hundredth of the region); nothing for what is not finite, zero or without a centre and of low rank.
/// Points x of the surface satisfy, with Q* = [ c c^T - S, c ; c^T, 1 ] and S = sum s_i e_i e_i^T: sum (e_i.(x - c))^2 / s_i = 1.
/// @param region  where to draw; not empty.
QuadricWire wireOf(const DualQuadric& quadric, const Eigen::AlignedBox3d& region);

}  // namespace glint::viz
