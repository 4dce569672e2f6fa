// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <charconv>
#include <string>

namespace glint {

/// A number as short as it can be without losing a bit: "0.1", "1e-10". In every locale with a point.
inline std::string shortestText(double v) {
  char buffer[32];
  return {buffer, std::to_chars(buffer, buffer + sizeof buffer, v).ptr};
}

}  // namespace glint
