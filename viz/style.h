// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "core/draw/colours.h"
#include "core/draw/selection.h"

namespace glint::viz {

// What core/draw describes is painted here.
using namespace draw;
using draw::Selection;  // not the automatic choice of a model, which has the same name

/// DejaVu Sans, which has the Greek letters that VTK's built-in font lacks; "" if the font is not installed.
std::string fontFile();

}  // namespace glint::viz
