// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace glint {

/// Range of a contour's level wherever one is given: a setting, a scene file, a synthetic scene.
inline constexpr double kLeastLevel = 1e-6, kMostLevel = 1 - 1e-6;

}  // namespace glint
