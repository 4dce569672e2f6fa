// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>

namespace glint {

/// The text that printf() of C would write, of any length: formatted("%.3g %%", 12.5). Numbers have a decimal point whatever
/// locale the process or the thread has set (Qt sets the user's for the whole process). Safe from every thread. Not fmt: the
/// compiler checks these formats at every call, and fmt's templates would be compiled in every file that writes a number.
[[gnu::format(printf, 1, 2)]] std::string formatted(const char* format, ...);

/// The number that the whole text is: "0.5", "-1e-3", "+2". No locale, no blanks, nothing behind it. Empty for anything else, and
/// for what is not finite or beyond the range of a double.
std::optional<double> numberFrom(std::string_view text);

/// A number as short as it can be without losing a bit: "0.1", "1e-10". In every locale with a point.
inline std::string shortestText(double v) {
  char buffer[32];
  return {buffer, std::to_chars(buffer, buffer + sizeof buffer, v).ptr};
}

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
