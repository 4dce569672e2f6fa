// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/lamps/observation.h"

namespace glint {

/// The circle through three points of a ball's rim, px: its centre is the point at equal distances from them.
/// @return  RankDeficient if they lie on a line, or so nearly that the circle is a million times their distance; NotFinite
Outcome<BallOutline> circleThrough(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c);

}  // namespace glint
