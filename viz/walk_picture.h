// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "viz/canvas.h"
#include "viz/walk_story.h"

namespace glint::viz {

/// The walk in section, S beside T, over a chart of alpha against the distance: what a widget draws, in its own px from the top
/// left.
struct WalkPicture {
  struct Line {
    std::vector<Eigen::Vector2d> points;
    Colour colour;
    double width = 1;
    Dash dash = Dash::Solid;
    bool filled = false;  ///< the polygon, translucent
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

/// Heights are stretched until the limit angle is drawn as about 25 degrees; the same stretch for S and T, and it is written
/// down.
/// @param textPx  height of a line of text.
WalkPicture walkPicture(const WalkStory& story, int step, double width, double height, double textPx, bool dark);

}  // namespace glint::viz
