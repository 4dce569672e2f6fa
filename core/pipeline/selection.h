// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/pipeline/inspection.h"

namespace glint {

/// One candidate of the automatic choice (method.md section 11).
struct Candidate {
  std::string model;
  int views = 0;                  ///< training views left out one at a time
  int answered = 0;               ///< of those, predicted and overlapping the observed contour
  double meanPct = 0;             ///< leave-one-view-out contour error, % of the equivalent diameter; NaN when none was answered
  double standardErrorPct = 0;    ///< of that mean
  double timeUs = 0;              ///< all fits and predictions
  std::string remark;             ///< "chosen", "simpler ones are as good", the first reason of a failure, ...
};

struct Selection {
  std::string model;              ///< "" when no candidate answered every view
  std::string why;                ///< one sentence
  std::vector<Candidate> candidates;
};

/// The simplest model whose leave-one-view-out contour error is within one standard error of the best, or under
/// `goodEnoughPct` when that is given. Uses training views only. Candidates are tried from simple to rich; with a tolerance
/// the search stops at the first that meets it: nothing richer is computed.
/// @param inspection  needs evidence and views; models need not have been fitted.
Selection selectModel(const Inspection& inspection, const std::optional<double>& goodEnoughPct, const ProgressFn& progress = {});

}  // namespace glint
