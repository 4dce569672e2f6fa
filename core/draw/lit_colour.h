// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/draw/colours.h"

namespace glint::draw {

/// Colour of what the user points at elsewhere, such as a symbol. No model, light or axis has it; texts in it can be read.
inline constexpr Colour kLitOnDark{0.35, 1.0, 1.0}, kLitOnLight{0.0, 0.47, 0.55};

}  // namespace glint::draw
