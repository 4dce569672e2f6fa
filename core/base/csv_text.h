// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace glint {

/// A CSV field: quoted when it holds a separator or a quote.
inline std::string csvText(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? "\"\"" : std::string(1, c);
  return out + "\"";
}

}  // namespace glint
