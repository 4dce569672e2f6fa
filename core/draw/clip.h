// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/draw/painter.h"

namespace glint::draw {

/// A polyline of at least two points.
struct Chain {
  std::vector<Eigen::Vector2d> points;
  bool closed = false;
};

/// The part of a polyline in a box, border included. A line that leaves it becomes open pieces; one wholly inside stays as
/// it is. Points that are not finite are left out. @param box  without width: everything
/// @see Liang & Barsky, A New Concept and Method for Line Clipping, 1984.
std::vector<Chain> chainsInside(const std::vector<Eigen::Vector2d>& points, bool closed, const Box& box);

}  // namespace glint::draw
