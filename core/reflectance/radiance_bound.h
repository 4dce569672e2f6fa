// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/reflectance/lobe.h"
#include "core/surface/part_bounds.h"

namespace glint {

/// An upper bound of log I of one lobe under one light (method.md section 7, up to the light's constant) over eight parts of a
/// surface. It holds for an extended light as well when the bounds allow for its points: its radiance is a mean of theirs.
/// @param roughness  m > 0.
Eight largestLogRadiance(Lobe lobe, double roughness, const PartBounds& parts);

}  // namespace glint
