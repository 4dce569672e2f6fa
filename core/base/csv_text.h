// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <string>
#include <string_view>

#include "core/base/number_text.h"

namespace glint {

/// Text of a cell that no spreadsheet takes for a formula: one that begins like a formula gets an apostrophe before it. Names
/// come from files of others, and a formula in a table can read other cells and start programs. Numbers stay as they are.
inline std::string withoutFormula(const std::string& text) {
  // The last four are = + - @ in full width, which spreadsheets take as well.
  constexpr std::array<std::string_view, 10> kBeginnings{
      "=", "+", "-", "@", "\t", "\r", "\xEF\xBC\x9D", "\xEF\xBC\x8B", "\xEF\xBC\x8D", "\xEF\xBC\xA0"};
  // Blanks and characters without width (U+00A0, U+200B to U+200D, U+2060, U+FEFF), which spreadsheets may pass over.
  constexpr std::array<std::string_view, 7> kPassedOver{
      " ", "\xC2\xA0", "\xE2\x80\x8B", "\xE2\x80\x8C", "\xE2\x80\x8D", "\xE2\x81\xA0", "\xEF\xBB\xBF"};
  std::string_view rest = text;
  const auto begins = [&](std::string_view with) { return rest.starts_with(with); };
  for (auto blank = kPassedOver.begin(); blank != kPassedOver.end();) {
    blank = std::find_if(kPassedOver.begin(), kPassedOver.end(), begins);
    if (blank != kPassedOver.end()) rest.remove_prefix(blank->size());
  }
  const bool mayBeFormula = rest.size() > 1 && std::any_of(kBeginnings.begin(), kBeginnings.end(), begins);
  return mayBeFormula && !numberFrom(std::string(rest)) ? "'" + text : text;
}

enum class CsvQuotes { WhereNeeded, Always };

/// A field of any CSV table of Glint: quoted if it holds a separator, a quote or the end of a line; never a formula.
inline std::string csvText(const std::string& text, CsvQuotes quotes = CsvQuotes::WhereNeeded) {
  const std::string cell = withoutFormula(text);
  if (quotes == CsvQuotes::WhereNeeded && cell.find_first_of(",\"\r\n") == std::string::npos) return cell;
  std::string out = "\"";
  for (const char c : cell) out += c == '"' ? "\"\"" : std::string(1, c);
  return out + "\"";
}

}  // namespace glint
