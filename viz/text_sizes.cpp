// SPDX-License-Identifier: BSD-3-Clause
#include "viz/text_sizes.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/number_text.h"

namespace glint::viz {

int fontSizeFor(int windowHeight) { return std::clamp(windowHeight / 55, 11, 40); }

double roundLength(double limit) {
  const double decade = std::pow(10.0, std::floor(std::log10(limit)));
  for (const double factor : {5.0, 2.0}) {
    if (factor * decade <= limit * (1 + 1e-12)) return factor * decade;
  }
  return decade;
}

std::string lengthText(double metres) {
  struct Unit {
    double size;
    const char* name;
  };
  static constexpr std::array<Unit, 5> units{{{1e3, "km"}, {1, "m"}, {1e-2, "cm"}, {1e-3, "mm"}, {1e-6, "um"}}};
  for (const Unit& unit : units) {
    if (metres >= unit.size * (1 - 1e-9) || unit.size == 1e-6) {
      return formatted("%.4g %s", metres / unit.size, unit.name);
    }
  }
  return {};
}

}  // namespace glint::viz
