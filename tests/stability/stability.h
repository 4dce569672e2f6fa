// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "core/base/progress.h"

namespace glint {

enum class CaseVerdict {
  Accurate,      ///< within the case's tolerance of the reference
  NamedFailure,  ///< a reason instead of an answer, where the case allows that
  Wrong,         ///< everything else: too far off, no number, an answer where none exists, a failure where there is an answer
};
/// "accurate", "named failure", "wrong".
const char* nameOf(CaseVerdict verdict);

/// One extreme and how the code met it.
struct StabilityResult {
  std::string name, stage;
  double parameter = 0;  ///< what was driven to the extreme; its unit is in the name
  /// Change of the answer over change of the input, both relative; the largest double without a unique answer.
  double condition = 1;
  double relativeError = 0;  ///< against a reference of higher precision; 1 where there is no answer
  double tolerance = 0;      ///< of the relative error
  CaseVerdict verdict = CaseVerdict::Wrong;
  std::string reason;  ///< of a named failure or of a wrong answer; empty if accurate
  std::string note;    ///< why this tolerance, or why a failure is right here
};

/// The extremes of method.md section 13, one after the other. Each compares the code with a reference of higher precision that
/// shares no code with it. Throws Stopped when `progress` says so. A minute or two.
/// @param stage  only its cases; "" = all. InputError if there is no such stage.
std::vector<StabilityResult> runStability(const ProgressFn& progress = {}, const std::string& stage = "");

/// Columns for a terminal, with a line of totals.
std::string stabilityTable(const std::vector<StabilityResult>& results);
/// The same for docs/stability.md, with the notes.
std::string stabilityMarkdown(const std::vector<StabilityResult>& results);
/// docs/formats.md, "stability --json".
std::string stabilityJson(const std::vector<StabilityResult>& results);

}  // namespace glint
