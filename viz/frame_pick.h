// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "core/draw/frame_overlay.h"
#include "viz/style.h"

namespace glint::viz {

/// What a click into a frame's picture selects. Near a drawn contour: its highlight, its light, the direction of the clicked
/// point and, on a prediction, its model; the selected model stays where a contour of it is near, too. Inside an observed
/// contour, away from the lines: that highlight as a whole. Elsewhere: no highlight.
///
/// @param now      what is selected; its frame is the clicked one.
/// @param shown    the overlay on screen.
/// @param clicked  photograph pixel.  @param nearPx  what counts as near, photograph pixels.
Selection pickInFrame(const Inspection& inspection, const Selection& now, const FrameOverlay& shown, const Pixel& clicked,
                      double nearPx);

/// What a hand can take in a frame's picture: an observed peak, else an observed contour, of the evidence that fits are made of.
struct Grip {
  int highlight = -1;  ///< index into FrameEvidence::highlights
  bool peak = false;
};
/// Nothing if neither is near, nor where what is shown is truth instead of that evidence.
std::optional<Grip> gripAt(const Inspection& inspection, int frame, const Pixel& at, double nearPx);

/// Label of the line or mark under a photograph pixel; "" without any.
std::string labelAt(const FrameOverlay& shown, const Pixel& at, double nearPx);

}  // namespace glint::viz
