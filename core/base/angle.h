// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <numbers>

namespace glint {

/// Angles are radians everywhere; degrees are for people and files.
constexpr double degrees(double rad) { return rad * (180 / std::numbers::pi); }
constexpr double radians(double deg) { return deg * (std::numbers::pi / 180); }

}  // namespace glint
