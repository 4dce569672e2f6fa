// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "core/light/estimate.h"

namespace glint {

/// Triangulation::condition of any rays, also of those that give no light: smallest over largest eigenvalue of sum (I - r r^T),
/// in [0, 1]; small = nearly parallel. 0 below two rays.
double conditionOf(const std::vector<ReflectedRay>& rays);

}  // namespace glint
