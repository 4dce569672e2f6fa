// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "core/draw/painter.h"

namespace glint::draw {

/// Where names are written that belong to points: beside their point, above to the right first, then below and to the left, then
/// in rows farther away; inside `area`, and never over one another or over a point. Nothing for a name without room.
/// @param widths  of the names, one for each point @param height  of a line @param scale  device pixels per screen px
std::vector<std::optional<Box>> notePlaces(const std::vector<Eigen::Vector2d>& points, const std::vector<double>& widths,
                                           double height, const Box& area, double scale);

}  // namespace glint::draw
