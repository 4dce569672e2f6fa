// SPDX-License-Identifier: BSD-3-Clause
#include <array>

#include "core/base/number_text.h"
#include "core/draw/plot_text.h"

namespace glint::draw {

const LobeStyle& lobeStyle(std::size_t place) {
  static constexpr std::array<LobeStyle, 4> kStyles{{{{0.55, 0.42, 0.85}, Dash::Dotted},
                                                     {{0.80, 0.55, 0.10}, Dash::Dashed},
                                                     {{0.25, 0.56, 0.86}, Dash::Solid},
                                                     {{0.20, 0.62, 0.35}, Dash::Solid}}};
  return kStyles[place % kStyles.size()];
}

std::string lobeText(const LobeComparison& comparison, std::size_t place) {
  const LobeMatch& match = comparison.matches[place];
  const std::string name(nameOf(match.lobe));
  if (match.failure) return name + ": " + match.failure->message();
  const char* const rank = int(place) == comparison.best ? ", best" : match.asGood ? ", as good" : "";
  return name + formatted(", m = %.4g, rms %.2g %%%s", match.m, match.rmsPct, rank);
}

}  // namespace glint::draw
