// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "core/base/image.h"
#include "core/base/outcome.h"
#include "core/lamps/observation.h"

namespace glint {

/// The outline of one ball from its photographs by one fixed camera. `photographs`: one or more of equal size, 8-bit values 0 to 255 as float, 1 or 3
/// channels; `corner`: the place of their first pixel in the shot; `start`: a rough outline in the shot's pixels (right to a tenth of its radius).
Outcome<RefinedOutline> refineBallOutline(std::span<const Image> photographs, const Eigen::Vector2d& corner,
                                          const BallOutline& start);

}  // namespace glint
