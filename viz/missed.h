// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "viz/frame_overlay.h"

namespace glint::viz {

/// The error of a frame that may be shown by itself. None where a highlight was missed: the others' mean would make that frame
/// look good.
std::optional<double> wholeErrorPct(const FrameScore& score);
/// "missed 1 of 2 highlights, the other: 0.13 %"; "" where none was.
std::string missedText(const FrameScore& score);

}  // namespace glint::viz
