// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/draw/frame_overlay.h"

namespace glint::draw {

/// Paints an overlay: photograph pixels of `crop` are stretched over `box` and cut at its border; marks are in or out by their
/// place. Marks and widths keep their screen size times `inkScale`. @param hints  labels answer the mouse (Painter::hint)
void paintOverlay(Painter& painter, const FrameOverlay& overlay, const Crop& crop, const Box& box, double inkScale = 1,
                  bool hints = false);

}  // namespace glint::draw
