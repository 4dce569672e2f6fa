// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Internal to io: lines, words and numbers of a text in memory, without copies and independent of the locale.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace glint::io {

inline bool isBlank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f'; }

/// The next word of a line, cut off its front; empty at its end.
inline std::string_view takeWord(std::string_view& line) {
  std::size_t from = 0;
  while (from < line.size() && isBlank(line[from])) ++from;
  std::size_t to = from;
  while (to < line.size() && !isBlank(line[to])) ++to;
  const std::string_view word = line.substr(from, to - from);
  line.remove_prefix(to);
  return word;
}

/// The text behind the mark of UTF-8 that some editors put in front.
inline std::string_view withoutMark(std::string_view text) {
  constexpr std::string_view kMark = "\xef\xbb\xbf";
  return text.starts_with(kMark) ? text.substr(kMark.size()) : text;
}

/// Lines of a text, behind the mark of UTF-8, that end with "\n", "\r\n", or with "\r" alone.
class Lines {
 public:
  /// Lines end with "\r" alone where the text has no "\n".
  explicit Lines(std::string_view text) : Lines(text, text.find('\n') == std::string_view::npos ? '\r' : '\n') {}
  Lines(std::string_view text, char end) : text_(text), at_(text.size() - withoutMark(text).size()), end_(end) {}
  /// Nothing at the end of the text.
  std::optional<std::string_view> next();
  std::size_t number() const { return number_; }  ///< of the line that `next` gave last, from 1
  std::size_t at() const { return at_; }          ///< first byte after it
  /// The last line had its line break.
  bool ended() const { return ended_; }

 private:
  std::string_view text_;
  std::size_t at_ = 0, number_ = 0;
  char end_;
  bool ended_ = false;
};

/// A number in the C locale, with an optional leading '+'. What is too small for a double is 0, what is too large an infinity.
/// Nothing unless the whole word is one number.
std::optional<double> numberOf(std::string_view word);
std::optional<std::int64_t> integerOf(std::string_view word);

/// A word of a file for a message: at most 40 bytes, what is no printable ASCII as '?'.
std::string quoted(std::string_view word);

}  // namespace glint::io
