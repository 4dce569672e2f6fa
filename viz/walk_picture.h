// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "viz/drawn_picture.h"
#include "viz/walk_story.h"

namespace glint::viz {

/// The walk in section, S beside T, over a chart of alpha against the distance.
using WalkPicture = DrawnPicture;

/// Heights are stretched until the limit angle is drawn as about 25 degrees; the same stretch for S and T, and it is written
/// down.
/// @param textPx  height of a line of text.
WalkPicture walkPicture(const WalkStory& story, int step, double width, double height, double textPx, bool dark);

}  // namespace glint::viz
