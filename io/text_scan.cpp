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

namespace {
/// What runtimes of Microsoft wrote before 2015: 1.#QNAN, -1.#IND00, 1.#INF.
std::optional<double> microsoftNumber(std::string_view word) {
  const bool negative = word.starts_with("-");
  if (negative) word.remove_prefix(1);
  if (!word.starts_with("1.#")) return std::nullopt;
  word.remove_prefix(3);
  while (word.ends_with("0")) word.remove_suffix(1);
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  if (word == "INF") return negative ? -kInfinity : kInfinity;
  if (word == "QNAN" || word == "SNAN" || word == "IND") return std::numeric_limits<double>::quiet_NaN();
  return std::nullopt;
}
}  // namespace

std::optional<double> numberOf(std::string_view word) {
  if (!word.empty() && word.front() == '+') {
    word.remove_prefix(1);
    if (!word.empty() && word.front() == '-') return std::nullopt;
  }
  double value = 0;
  const char* const end = word.data() + word.size();
  const auto [stop, error] = std::from_chars(word.data(), end, value);
  if (stop != end || error == std::errc::invalid_argument) return microsoftNumber(word);
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
