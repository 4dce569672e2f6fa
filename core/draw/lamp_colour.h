// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/draw/colours.h"

namespace glint::draw {

inline constexpr Colour kMeasuredLamp{
    0.42, 0.74, 0.13};  ///< neither a model's, nor that of a scene's lights; also of balls' refined outlines

}  // namespace glint::draw
