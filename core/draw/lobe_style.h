// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <string>

#include "core/diagnostics/lobe_comparison.h"
#include "core/draw/colours.h"
#include "core/draw/painter.h"

namespace glint::draw {

/// A lobe's line in plots and over photographs: no model's colour, and told apart by the dash as well.
struct LobeStyle {
  Colour colour;
  Dash dash;
};

/// @param place  of the lobe in LobeComparison::matches
inline const LobeStyle& lobeStyle(std::size_t place) {
  static constexpr std::array<LobeStyle, 4> kStyles{{{{0.55, 0.42, 0.85}, Dash::Dotted},
                                                     {{0.80, 0.55, 0.10}, Dash::Dashed},
                                                     {{0.25, 0.56, 0.86}, Dash::Solid},
                                                     {{0.20, 0.62, 0.35}, Dash::Solid}}};
  return kStyles[place % kStyles.size()];
}

/// "GGX, m = 0.1203, rms 0.61 %, best", or the reason why there is none.
std::string lobeText(const LobeComparison& comparison, std::size_t place);

}  // namespace glint::draw
