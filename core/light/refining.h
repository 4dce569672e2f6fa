// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// What the refinements of poses, depth and normals agree on.

namespace glint::refining {

/// Share of the points that count as independent, from which residuals are noise. Below it they keep their sign along contours,
/// and something systematic is left; white noise leaves nearly all of them.
inline constexpr double kSystematic = 0.5;
/// The accuracy of detection (px): below it poses, depth and normals would be bent to round-off.
inline constexpr double kLeastNoisePx = 0.02;

}  // namespace glint::refining
