// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "core/inspect/inspection.h"
#include "core/score/statistic.h"

namespace glint {

/// How far the contours that the frames' own pixels gave lie from the truth that `--truth` names: whoever trusts an error against own
/// detection must know this one.
struct DetectionError {
  Statistic contourErrorPct, contourErrorPx;  ///< over highlights that overlap a true one, all frames
  int frames = 0;                             ///< with truth
  int missed = 0;                             ///< true highlights without a detected one
};
/// What one frame adds to it: the errors of its pairs in percent and pixels, and its missed highlights.
struct FrameDetection {
  std::vector<double> percent, pixels;
  int missed = 0;
};
/// Nothing for a frame without truth, or that was not looked at.
std::optional<FrameDetection> detectionOf(const FrameEvidence& evidence);
/// From frames in order. None where no frame has a pair.
std::optional<DetectionError> detectionError(const std::vector<FrameDetection>& frames);
/// None without truth, or where no frame's highlights were detected.
std::optional<DetectionError> detectionError(const Inspection& inspection);

}  // namespace glint
