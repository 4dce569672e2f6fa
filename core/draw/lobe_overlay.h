// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/draw/frame_overlay.h"

namespace glint::draw {

/// The highlight under every lobe that is fitted to its pixels: the contour at the level of the best lobe's peak, and in thinner
/// lines the contour at kTailShare of that level, where lobes differ most. Lines look as in the plot "Every lobe". Each lobe has
/// a caption, or the reason why it is missing.
/// @param highlight  index into FrameEvidence::scored(); -1 = the first
void addLobes(const FrameSamples& samples, int highlight, FrameOverlay& overlay);

/// Share of the level: low enough to tell a long tail, high enough for LobeOptions::reach (GGX: 1.95 of 2.2 times the contour).
inline constexpr double kTailShare = 0.3;

}  // namespace glint::draw
