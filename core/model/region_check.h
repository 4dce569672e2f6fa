// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "core/model/star_level_set.h"

namespace glint {

/// Why it is not certain that nothing of the visible, lit surface between two corners of the image is inside { value < level }
/// but what the outlines enclose; empty where it is. Surfaces that know bounds of their parts rule out all others by them;
/// elsewhere a grid of rays stands for the parts. What remains and is not near an outline is looked at by rays a few pixels
/// apart.
std::optional<Failure> somethingElseInside(const StarField& field, const Camera& camera, const Surface& surface,
                                           const std::vector<StarOutline>& outlines, double level, const Pixel& min,
                                           const Pixel& max);

}  // namespace glint
