// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/frame_score.h"

#include <algorithm>
#include <cmath>

#include "core/base/number_text.h"

namespace glint {

std::vector<std::string> modelsInOrder(const Inspection& inspection, const std::set<std::string>& only) {
  const std::vector<std::string> known = modelIds();
  std::vector<std::string> names;
  const auto take = [&](const std::string& name) {
    if (only.empty() || only.count(name)) names.push_back(name);
  };
  for (const std::string& name : known) {
    if (inspection.models.count(name)) take(name);
  }
  for (const auto& [name, result] : inspection.models) {
    if (std::find(known.begin(), known.end(), name) == known.end()) take(name);
  }
  return names;
}

namespace {

/// Sums over the comparisons of one frame.
class ScoreSum {
 public:
  void add(const FrameComparison& comparison) {
    note(comparison.prediction.failure());
    if (!comparison.prediction.highlights().empty()) {
      ++predictedLights_;
      iou_ += comparison.iou;
    }
    for (const FrameComparison::Row& row : comparison.rows) {
      if (row.observed < 0) {
        if (row.predicted >= 0) ++score_.spurious;     // else nothing could be compared
      } else if (row.predicted < 0 || !row.metrics) {  // what could not be compared must not make the frame look good either
        ++score_.missed;
      } else if (std::isfinite(row.metrics->contourErrorPct)) {
        ++score_.matched;
        pct_ += row.metrics->contourErrorPct;
        px_ += row.metrics->contourErrorPx;
      }
      if (row.failure) note(&*row.failure);
    }
  }
  FrameScore score() const {
    FrameScore score = score_;
    if (score.matched > 0) {
      score.errorPct = pct_ / score.matched;
      score.errorPx = px_ / score.matched;
    } else {
      score.reason = reason_;
    }
    if (predictedLights_ > 0) score.iou = iou_ / predictedLights_;
    return score;
  }

 private:
  void note(const Failure* failure) {
    if (failure && reason_.empty()) reason_ = failure->message();
  }
  FrameScore score_;
  double pct_ = 0, px_ = 0, iou_ = 0;
  int predictedLights_ = 0;
  std::string reason_;
};

}  // namespace

std::optional<double> wholeErrorPct(const FrameScore& score) { return score.missed > 0 ? std::nullopt : score.errorPct; }

std::string missedText(const FrameScore& score) {
  if (score.missed == 0) return {};
  const int all = score.missed + score.matched;
  if (score.matched == 0) return all == 1 ? "missed the highlight" : "missed all " + std::to_string(all) + " highlights";
  return "missed " + std::to_string(score.missed) + " of " + std::to_string(all) + " highlights, the other" +
         (score.matched > 1 ? "s: mean " : ": ") + errorText(*score.errorPct) + " %";
}

std::string spuriousText(const FrameScore& score) {
  if (score.spurious == 0) return {};
  return std::to_string(score.spurious) + " spurious highlight" + (score.spurious == 1 ? "" : "s") +
         ": predicted where none is seen";
}

FrameScore scoreOf(const FrameComparison& comparison) {
  ScoreSum sum;
  sum.add(comparison);
  return sum.score();
}

FrameScore frameScore(const ModelResult& result, int frame) {
  ScoreSum sum;
  for (const FrameComparison& comparison : result.frames)
    if (comparison.frame == frame) sum.add(comparison);
  return sum.score();
}

std::vector<FrameScore> frameScores(const ModelResult& result, int frames) {
  std::vector<ScoreSum> sums(static_cast<std::size_t>(std::max(0, frames)));
  for (const FrameComparison& comparison : result.frames)
    if (comparison.frame >= 0 && comparison.frame < frames) sums[static_cast<std::size_t>(comparison.frame)].add(comparison);
  std::vector<FrameScore> scores;
  scores.reserve(sums.size());
  for (const ScoreSum& sum : sums) scores.push_back(sum.score());
  return scores;
}

}  // namespace glint
