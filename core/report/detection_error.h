// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "core/inspect/inspection.h"
#include "core/score/statistic.h"

namespace glint {

/// Distance of the contours detected in the frames' own pixels from the truth of `--truth`: whether to trust an error against
/// own detection depends on it.
struct DetectionError {
  Statistic contourErrorPct, contourErrorPx;  ///< over highlights that overlap a true one, all frames
  int frames = 0;                             ///< with truth
  int missed = 0;                             ///< true highlights without a detected one
};
/// None without truth, or where no frame's highlights were detected.
std::optional<DetectionError> detectionError(const Inspection& inspection);

}  // namespace glint
