// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "core/draw/selection.h"
#include "core/pipeline/frame_score.h"

namespace glint::draw {

bool isSpurious(const FrameComparison& c, int predicted) {
  return std::any_of(c.rows.begin(), c.rows.end(), [&](const FrameComparison::Row& row) {
    return predicted >= 0 && row.predicted == predicted && row.observed < 0;
  });
}

std::vector<std::string> missedBy(const Inspection& inspection, int frame, int observed,
                                  const std::function<bool(const std::string&)>& counts) {
  std::vector<std::string> models;
  for (const std::string& model : modelsInOrder(inspection)) {
    if (!counts(model)) continue;
    const std::vector<FrameComparison>& frames = inspection.models.at(model).frames;
    const bool missed = std::any_of(frames.begin(), frames.end(), [&](const FrameComparison& c) {
      return c.frame == frame && std::any_of(c.rows.begin(), c.rows.end(), [&](const FrameComparison::Row& row) {
               return row.observed == observed && row.predicted < 0;
             });
    });
    const auto answers = [](const FrameComparison& c) { return !c.prediction.highlights().empty(); };
    if (missed && std::any_of(frames.begin(), frames.end(), answers)) models.push_back(model);
  }
  return models;
}

std::map<int, FrameUnmatched> unmatchedByFrame(const Inspection& inspection) {
  std::map<int, FrameUnmatched> unmatched;
  for (const std::string& model : modelsInOrder(inspection)) {
    const std::vector<FrameComparison>& frames = inspection.models.at(model).frames;
    const bool answers =
        std::any_of(frames.begin(), frames.end(), [](const auto& c) { return !c.prediction.highlights().empty(); });
    for (const FrameComparison& c : frames)
      for (const FrameComparison::Row& row : c.rows) {
        if (row.observed < 0 && row.predicted >= 0) unmatched[c.frame].spurious.push_back({model, c.light, row.predicted});
        if (row.observed >= 0 && row.predicted < 0 && answers) unmatched[c.frame].missedBy[row.observed].push_back(model);
      }
  }
  return unmatched;
}

UnmatchedRow selectedUnmatched(const Inspection& inspection, const Selection& s, const std::string& model) {
  const auto result = inspection.models.find(s.model.empty() ? model : s.model);
  if (result == inspection.models.end()) return {};
  for (const FrameComparison& c : result->second.frames) {
    if (c.frame != s.frame || (!s.light.empty() && c.light != s.light)) continue;
    for (const FrameComparison::Row& row : c.rows) {
      const bool spurious = s.highlight < 0 && s.predicted >= 0 && row.observed < 0 && row.predicted == s.predicted;
      const bool missed = s.highlight >= 0 && row.observed == s.highlight && !row.metrics;
      if (spurious || missed) return {&c, &row};
    }
  }
  return {};
}

const PredictedHighlight* selectedSpurious(const Inspection& inspection, const Selection& s) {
  if (s.highlight >= 0 || s.predicted < 0 || s.model.empty()) return nullptr;
  const UnmatchedRow found = selectedUnmatched(inspection, s, s.model);
  if (!found.comparison) return nullptr;
  const std::vector<PredictedHighlight>& all = found.comparison->prediction.highlights();
  return found.row->predicted < static_cast<int>(all.size()) ? &all[static_cast<std::size_t>(found.row->predicted)] : nullptr;
}

}  // namespace glint::draw
