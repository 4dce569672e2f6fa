// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "core/base/image.h"
#include "viz/canvas.h"

namespace glint::test {

constexpr double kBlurPx = 1.5;  ///< standard deviation: finer detail, such as how a driver smooths an edge, is not compared
constexpr double kSeenDeltaE =
    10;  ///< CIELAB distance; 2.3 is just noticeable with two patches side by side, thin lines need more
/// Shares of the pixels that may differ. Measured: edges moved by 0.3 px, as another driver might, change at most 0.0022, the
/// least visible layer at least 0.0098; the ring about a selected sample of a plot 0.0023. Pictures that no driver draws: the
/// least visible layer changes 0.0009.
constexpr double kMostSeen = 0.003, kMostSeenInPlots = 0.0015, kMostSeenWithoutDriver = 0.0004;

/// Share of the pixels where an eye would see a difference: after a small blur, one picture has a colour there that the other one
/// does not have within a pixel, by the distance in CIELAB (CIE 1976). 1 for pictures of different sizes. @param a, b  3
/// channels, sRGB 0..1. @param masked  rectangles that are not compared (text: fonts differ between machines).
double seenShare(const Image& a, const Image& b, const std::vector<draw::Box>& masked = {});

/// tests/viz/pictures/NAME.png. Fails the test when it cannot be read.
Image storedPicture(const std::string& name);
/// Writes it, if GLINT_STORE_PICTURES is set.
void storePicture(const std::string& name, const Image& now);

}  // namespace glint::test
