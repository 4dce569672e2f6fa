// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "core/base/image.h"
#include "core/base/outcome.h"
#include "core/lamps/observation.h"

namespace glint {

/// The reflection of the lamp on a mirror ball. `photograph`: 8-bit values 0 to 255 as float, 1 or 3 channels; `corner`: the place of its first pixel in
/// the shot; `balls`: the outlines of all balls in the shot; `which`: the ball to look at.
Outcome<LampObservation> findLampHighlight(const Image& photograph, const Eigen::Vector2d& corner,
                                           std::span<const BallOutline> balls, std::size_t which);

}  // namespace glint
