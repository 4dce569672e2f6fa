// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Internal to this folder: what a part of an evaluation holds beside the evaluation itself, so that the whole can be computed from parts.

#include <optional>
#include <string>
#include <vector>

#include "core/base/json_text.h"
#include "core/inspect/summary.h"
#include "core/report/detection_error.h"
#include "core/report/evaluation_notes.h"

namespace glint::evaluation {

struct FrameRecord {
  FrameNote note;
  std::optional<FrameDetection> detection;
};
struct ComparisonRecord {
  ComparisonTally tally;
  int rows = 0;  ///< how many of the model's `frames` are this comparison's
};
/// Where a fit stands among those of all parts: what it was first seen by (0 = a training highlight, 1 = a scored one, 2 = neither), and in
/// which frame. And how many of the remarks of the model's `band` are its own.
struct FitOrder {
  int seenBy = 2, frame = 0, bandRemarks = 0;
  bool before(const FitOrder& other) const { return seenBy != other.seenBy ? seenBy < other.seenBy : frame < other.frame; }
};

// As JSON text. Numbers that are not finite are null, and NaN when they are read back.
std::string jsonOf(const FrameRecord& record);
std::string jsonOf(const ComparisonRecord& record);
std::string jsonOf(const FitOrder& order);

// InputError (file, place) for another form and for counts below 0.
FrameRecord readFrameRecord(const JsonNode& node);
ComparisonRecord readComparisonRecord(const JsonNode& node);
FitOrder readFitOrder(const JsonNode& node);

}  // namespace glint::evaluation
