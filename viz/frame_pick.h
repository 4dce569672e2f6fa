// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "viz/frame_overlay.h"

namespace glint::viz {

/// What a click into a frame's picture selects. Near a drawn contour: its highlight, its light, the direction of the clicked
/// point and, on a prediction, its model. Inside an observed contour, away from the lines: that highlight as a whole. Elsewhere:
/// no highlight.
///
/// @param now      what is selected; its frame is the clicked one.
/// @param shown    the overlay on screen.
/// @param clicked  photograph pixel.  @param nearPx  what counts as near, photograph pixels.
Selection pickInFrame(const Inspection& inspection, const Selection& now, const FrameOverlay& shown, const Pixel& clicked,
                      double nearPx);

/// Label of the line or mark under a photograph pixel; "" when there is none.
std::string labelAt(const FrameOverlay& shown, const Pixel& at, double nearPx);

}  // namespace glint::viz
