// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <string>

#include "core/base/number_text.h"
#include "core/base/safe_text.h"

namespace glint::html {

/// One number by a printf pattern; a dash when it is not finite.
inline std::string format(const char* pattern, double v) {
  if (!std::isfinite(v)) return "&ndash;";
  return formatted(pattern, v);
}

/// Text from anywhere as it is, never as markup; control characters are shown escaped.
inline std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : withoutControls(text)) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '"')
      out += "&quot;";
    else
      out += c;
  }
  return out;
}

}  // namespace glint::html
