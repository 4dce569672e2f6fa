// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/pipeline/inspection.h"

namespace glint {

/// One model's score in one frame over all lights and highlights.
struct FrameScore {
  std::optional<double> errorPct, errorPx;  ///< mean over matched highlights
  std::optional<double> iou;                ///< mean over lights that were predicted
  int matched = 0, missed = 0, spurious = 0;
  std::string reason;  ///< first failure's message when nothing matched; else ""
};
FrameScore frameScore(const ModelResult& result, int frame);
/// The score of one light alone.
FrameScore scoreOf(const FrameComparison& comparison);
/// The same for the frames 0 .. frames - 1, in one pass.
std::vector<FrameScore> frameScores(const ModelResult& result, int frames);

/// The error of a frame that may be shown by itself. None if a highlight was missed: the others' mean would make that frame
/// look good.
std::optional<double> wholeErrorPct(const FrameScore& score);
/// "missed 1 of 2 highlights, the other: 0.13 %"; "" if none was.
std::string missedText(const FrameScore& score);
/// "2 spurious highlights: predicted where none is seen"; "" without spurious ones.
std::string spuriousText(const FrameScore& score);

/// Names of the inspection's models, from simple to rich (method.md section 7), unknown ones last; only those in `only` unless it
/// is empty.
std::vector<std::string> modelsInOrder(const Inspection& inspection, const std::set<std::string>& only = {});

}  // namespace glint
