// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/draw/frame_overlay.h"

namespace glint::draw {

/// The highlight under every lobe: where each lobe that is fitted to its pixels has the contour level of the best one's peak, and, in thinner
/// lines, kTailShare of that level, where lobes differ most. Lines as those of the plot "Every lobe", with a caption for each lobe or for the
/// reason why there is none.
/// @param highlight  index into FrameEvidence::scored(); -1 = the first
void addLobes(const FrameSamples& samples, int highlight, FrameOverlay& overlay);

/// Of the level: low enough to tell a long tail, high enough to lie within what LobeOptions::reach samples (GGX: 1.95 of 2.2 times the contour).
inline constexpr double kTailShare = 0.3;

}  // namespace glint::draw
