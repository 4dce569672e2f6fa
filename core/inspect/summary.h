// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "core/inspect/inspection.h"
#include "core/score/statistic.h"

namespace glint {

/// What `evaluate` prints of one model (docs/formats.md, "evaluate --json"): held-out frames only, except per surface.
struct ModelSummary {
  bool answered = false;                      ///< some frame was predicted
  std::string reason;                         ///< why not, when it was not
  int frames = 0;                             ///< (frame, light) pairs that should be predicted
  int predicted = 0;                          ///< of those, pairs with a prediction
  int matched = 0, missed = 0, spurious = 0;  ///< highlights
  Statistic contourErrorPct, contourErrorPx, ellipseErrorPct, hausdorffPx, peakOffsetPx, coverage;  ///< over matched highlights
  Statistic iou;  ///< per (frame, light), over the union of all regions
  Statistic timeUs;
  double timeP99Us = 0;
};
ModelSummary summarise(const Inspection& inspection, const ModelResult& result);

}  // namespace glint
