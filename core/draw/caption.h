// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "core/draw/painter.h"

namespace glint::draw {

/// A caption under a figure: lines that the width of the page broke.
struct Caption {
  std::vector<std::string> lines;
  double sizePx = 0;
  double height = 0;  ///< px, with the room above and below the lines; 0 = no caption
};

/// Breaks a caption at blanks; a word that is wider than the page is cut. What exceeds `mostHeight` ends in an ellipsis.
/// @param painter  measures
/// @param width    px of the whole picture
Caption captionOf(const Painter& painter, const std::string& text, double sizePx, double width, double mostHeight);
/// Paints it from `top` down; the ground is the caller's.
void paintCaption(Painter& painter, const Caption& caption, double top, const Colour& ink);

}  // namespace glint::draw
