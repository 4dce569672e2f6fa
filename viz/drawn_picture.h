// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "viz/canvas.h"

namespace glint::viz {

/// What a widget paints by itself, in its own px from the top left: polygons and lines in their order, then dots, then texts.
struct DrawnPicture {
  struct Line {
    std::vector<Eigen::Vector2d> points;
    Colour colour;
    double width = 1;
    Dash dash = Dash::Solid;
    bool filled = false;    ///< the polygon, translucent
    double opacity = 0.45;  ///< of a filled one
  };
  struct Dot {
    Eigen::Vector2d at;
    Colour colour;
    double radius = 3;
  };
  struct Text {
    Eigen::Vector2d at;  ///< baseline's left end, middle or right end
    std::string text;
    Colour colour;
    Align align = Align::Left;
    bool strong = false;
  };
  std::vector<Line> lines;
  std::vector<Dot> dots;
  std::vector<Text> texts;
};

}  // namespace glint::viz
