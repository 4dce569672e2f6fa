// SPDX-License-Identifier: BSD-3-Clause
#pragma once

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
const LobeStyle& lobeStyle(std::size_t place);

/// "ggx, m = 0.1203, rms 0.61 %, best", or the reason why it is missing.
std::string lobeText(const LobeComparison& comparison, std::size_t place);

}  // namespace glint::draw
