// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Internal to core: numbers in JSON that is written.

#include <cmath>
#include <nlohmann/json.hpp>

namespace glint {

/// JSON has no NaN and no infinity: null stands for both.
inline nlohmann::ordered_json numberOrNull(double v) { return std::isfinite(v) ? nlohmann::ordered_json(v) : nlohmann::ordered_json(); }

}  // namespace glint
