// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/number_text.h"

#include <locale.h>

#include <charconv>
#include <clocale>
#include <cmath>
#include <cstdarg>
#include <cstdio>

namespace glint {

std::string formatted(const char* format, ...) {
  static const locale_t plain = newlocale(LC_ALL_MASK, "C", nullptr);  // one for the process, never freed
  const locale_t before = uselocale(plain);                            // of this thread only
  std::va_list values, again;
  va_start(values, format);
  va_copy(again, values);
  char buffer[256];
  const int length = std::vsnprintf(buffer, sizeof buffer, format, values);
  va_end(values);
  std::string text;
  if (length > 0 && std::size_t(length) < sizeof buffer) text = buffer;
  if (length > 0 && text.empty()) {
    text.resize(std::size_t(length));
    std::vsnprintf(text.data(), text.size() + 1, format, again);
  }
  va_end(again);
  uselocale(before);
  return text;
}

std::optional<double> numberFrom(std::string_view text) {
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);  // from_chars knows no plus
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

}  // namespace glint
