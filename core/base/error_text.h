// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <string>

#include "core/base/number_text.h"

namespace glint {

/// An error for a legend or a caption: three significant digits, and no more than two decimals, so that small ones stay in line:
/// "0.05", "2.67", "12.3", "1010". "-" where it is not finite.
/// @param value  >= 0, in % or px; the unit is not written.
inline std::string errorText(double value) {
  if (!std::isfinite(value)) return "-";
  // The limits are those from which a value is rounded up to the next power of ten.
  double rounded = value;
  int decimals = 2;
  if (value >= 99.95) {
    const double step = std::pow(10, std::max(0.0, std::floor(std::log10(value)) - 2));
    rounded = step * std::round(value / step);
    decimals = 0;
  } else if (value >= 9.995) {
    decimals = 1;
  }
  return formatted("%.*f", decimals, rounded);
}

}  // namespace glint
