// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace glint {

/// `std::snprintf` that never depends on the locale: numbers have a decimal point, whatever the process or the thread has set. (Qt sets
/// the user's locale for the whole process.) Safe from every thread.
[[gnu::format(printf, 3, 4)]] int printText(char* buffer, std::size_t size, const char* format, ...);

/// One number in a short text, as printText writes it: formatted("%.3g %%", 12.5). At most 255 bytes.
inline std::string formatted(const char* format, double value) {
  char text[256];
  printText(text, sizeof text, format, value);
  return text;
}

/// The number that the whole text is: "0.5", "-1e-3", "+2". No locale, no blanks, nothing behind it. Empty for anything else, and for what
/// is not finite or beyond the range of a double.
std::optional<double> numberFrom(std::string_view text);

}  // namespace glint
