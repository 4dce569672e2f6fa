// SPDX-License-Identifier: BSD-3-Clause
#include "io/text_scan.h"

#include <algorithm>
#include <charconv>
#include <limits>

namespace glint::io {

std::optional<std::string_view> Lines::next() {
  if (at_ >= text_.size()) return std::nullopt;
  const std::size_t end = text_.find(end_, at_);
  ended_ = end != std::string_view::npos;
  std::string_view line = text_.substr(at_, (ended_ ? end : text_.size()) - at_);
  at_ = ended_ ? end + 1 : text_.size();
  ++number_;
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  return line;
}

std::optional<double> numberOf(std::string_view word) {
  if (!word.empty() && word.front() == '+') {
    word.remove_prefix(1);
    if (!word.empty() && word.front() == '-') return std::nullopt;
  }
  double value = 0;
  const char* const end = word.data() + word.size();
  const auto [stop, error] = std::from_chars(word.data(), end, value);
  if (stop != end || error == std::errc::invalid_argument) return std::nullopt;
  if (error == std::errc::result_out_of_range) {
    // Too small or too large: the exponent tells, and without one the digits before the point.
    const bool negative = word.front() == '-';
    const std::size_t exponent = word.find_first_of("eE");
    const std::size_t point = std::min(word.find('.'), word.size());
    const std::size_t digit = word.find_first_of("123456789");
    const bool small = exponent != std::string_view::npos ? word.substr(exponent + 1).front() == '-' : digit > point;
    const double size = small ? 0 : std::numeric_limits<double>::infinity();
    return negative ? -size : size;
  }
  return value;
}

std::optional<std::int64_t> integerOf(std::string_view word) {
  if (word.size() > 1 && word.front() == '+' && word[1] != '-') word.remove_prefix(1);
  std::int64_t value = 0;
  const char* const end = word.data() + word.size();
  const auto [stop, error] = std::from_chars(word.data(), end, value);
  if (stop != end || error != std::errc()) return std::nullopt;
  return value;
}

std::string quoted(std::string_view word) {
  constexpr std::size_t kMost = 40;
  std::string text = "'";
  for (const char c : word.substr(0, kMost)) text += c >= ' ' && c <= '~' ? c : '?';
  if (word.size() > kMost) text += "...";
  return text + "'";
}

}  // namespace glint::io
