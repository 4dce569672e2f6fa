// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "core/model/star_level_set.h"

namespace glint {

/// Why it is not certain that, between two corners of the image, only what the outlines enclose of the visible, lit surface is
/// inside { value < level }; empty where it is certain. Surfaces that know bounds of their parts rule out all others by them;
/// elsewhere a grid of rays stands for the parts. Rays a few pixels apart look at what remains and is not near an outline.
std::optional<Failure> somethingElseInside(const StarField& field, const Camera& camera, const Surface& surface,
                                           const std::vector<StarOutline>& outlines, double level, const Pixel& min,
                                           const Pixel& max);

}  // namespace glint
