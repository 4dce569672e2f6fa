// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

namespace glint {

/// IEC 61966-2-1, codes and linear light in [0, 1].
inline double linearFromSrgb(double v) { return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4); }
inline double srgbFromLinear(double v) { return v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055; }

}  // namespace glint
