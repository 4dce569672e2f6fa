// SPDX-License-Identifier: BSD-3-Clause
#pragma once

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

}  // namespace glint
