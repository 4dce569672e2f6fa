// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "core/advise/highlight_rows.h"

namespace glint {

/// The row of `before` that is about the same highlight under the same model as each row of `after`: its place, or -1. Observed
/// highlights are the same where their peaks are, or where they are the only ones of their light left in their frame, or else by
/// greatest overlap. What is spurious has no counterpart.
/// @param before, after  highlightRows() of two evaluations of one scene; their evidence may differ
std::vector<int> counterparts(const Inspection& before, const std::vector<HighlightRow>& rowsBefore, const Inspection& after,
                              const std::vector<HighlightRow>& rowsAfter);

/// How one model's errors in held-out frames changed. The means hold highlights with an error in both runs; the rest is counted.
struct ErrorChange {
  std::string model;
  int highlights = 0, frames = 0;        ///< in the means
  double meanBefore = 0, meanAfter = 0;  ///< %; NaN where `highlights` is 0
  int better = 0, worse = 0;             ///< of `highlights`; the others stay as they were, to nine digits
  int lost = 0, gained = 0;              ///< held out in both, with an error only before, or only after
  /// Observed highlights of held-out frames without an error: missed, failed or refused.
  int withoutBefore = 0, withoutAfter = 0;
  int spuriousBefore = 0, spuriousAfter = 0;
  int elsewhere = 0;  ///< highlights with an error in both that are not held out in both: they do not count
};

/// One for each model that both have, from simple to rich.
std::vector<ErrorChange> errorChanges(const Inspection& before, const std::vector<HighlightRow>& rowsBefore,
                                      const Inspection& after, const std::vector<HighlightRow>& rowsAfter);
/// "held-out mean 4.1 % → 2.3 % (12 highlights in 12 frames: 9 better, 3 worse)", and in words what is in only one of both.
std::string textOf(const ErrorChange& change);

/// Same to nine digits, as `glint replay` compares.
bool sameError(double a, double b);

}  // namespace glint
