// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "core/geometry/light.h"
#include "core/light/estimate.h"

namespace glint {

/// A lamp that most views have in common, by the mirrored rays of their highlights alone: no shape of a highlight has a say.
struct SharedLamp {
  Light light;
  std::vector<int> chosen;     ///< of each view, the ray that passes the lamp best; -1 if the view has none
  std::vector<double> misses;  ///< of each view, rad: by which that ray passes the lamp; pi without a ray
  double miss = 0;             ///< largest one of the best three quarters of the views
};

/// The lamp that rays pass most closely, sought among the places where two rays of different views come nearest to each other,
/// and the directions of single rays. A view may show other lamps, too, or a highlight twice.
/// @param views  the mirrored rays of each view's highlights; a view may have none
/// @return nothing if fewer than two views have a ray
std::optional<SharedLamp> sharedLamp(const std::vector<std::vector<ReflectedRay>>& views);

/// Mean square of the least three quarters of the misses, rad^2; pi^2 without a lamp.
double squaredMiss(const std::optional<SharedLamp>& lamp);

}  // namespace glint
