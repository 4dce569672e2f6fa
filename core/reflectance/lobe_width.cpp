// SPDX-License-Identifier: BSD-3-Clause
#include "core/reflectance/lobe_width.h"

#include <cmath>

#include "core/base/outcome.h"
#include "core/reflectance/lobe_terms.h"

namespace glint {

double widthOf(Lobe lobe, double roughness, double level) {
  require(roughness > 0 && std::isfinite(roughness) && level > 0 && level < 1, "widthOf: roughness and level");
  return lobe::withLobe(lobe, [&](const auto& l) {
    // The last crossing: a wide Beckmann lobe first rises, because 1 / cos^4 outweighs its exponential there.
    double low = 0, high = 1.4;  // rad; a GGX lobe with m near 1 never falls that far
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (low + high);
      (l.fall(roughness, middle) < -std::log(level) ? low : high) = middle;
    }
    return 0.5 * (low + high);
  });
}

double roughnessOf(Lobe lobe, double width, double level) {
  require(width > 0 && width < M_PI / 2 && level > 0 && level < 1, "roughnessOf: width and level");
  return lobe::withLobe(lobe, [&](const auto& l) { return l.roughnessOf(width, -std::log(level)); });
}

}  // namespace glint
