// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace glint {

/// A unit as windows and pictures write it; settings, terminals and files keep plain ASCII.
inline std::string writtenUnit(const std::string& unit) { return unit == "px^2" ? "px²" : unit == "deg" ? "°" : unit; }

/// What follows a number: " px", but "°" without a blank, as the SI writes angles; "" without a unit.
inline std::string unitAfterNumber(const std::string& unit) {
  const std::string written = writtenUnit(unit);
  return written.empty() || written == "°" ? written : " " + written;
}

}  // namespace glint
