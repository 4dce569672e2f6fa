// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/pipeline/inspection.h"
#include "core/pipeline/metrics.h"
#include "core/pipeline/summary.h"
#include "core/report/report.h"

namespace glint {

/// What an evaluation says, in sentences for a person who does not read its tables.
struct EvaluationWords {
  std::string best;  ///< the model that they are about: the chosen one, else bestModel(); "" = none answered
  /// A diagnosis' advice, how good it is, what it misses and invents, the next best, models without answer and why.
  std::vector<std::string> inShort;
  /// Reasons for doubt: what it is scored against, how few frames, remarks of the best model's fits.
  std::vector<std::string> doubts;
};
EvaluationWords evaluationWords(const Inspection& inspection, const ReportContext& context);

/// How much larger the errors of one model are than those of another, over the held-out highlights that both matched.
struct ErrorDifference {
  int highlights = 0;
  double meanPct = 0;           ///< of other - best, % of the diameter; NaN without highlights
  double standardErrorPct = 0;  ///< of that mean, as if highlights were independent; NaN with fewer than two
  /// Larger than two standard errors: chance alone makes such a difference once in twenty times.
  bool isClear() const { return meanPct > 2 * standardErrorPct; }
};
ErrorDifference errorDifference(const Inspection& inspection, const std::string& best, const std::string& other);

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

namespace glint::evaluation {

/// By name, in the order of the request.
BestModel bestOf(const std::vector<std::pair<std::string, ModelSummary>>& models);

}  // namespace glint::evaluation
