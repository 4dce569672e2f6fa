// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/app/session.h"

namespace glint {

/// One thing that two runs may have in common.
struct ComparedValue {
  std::string group;  ///< "input", "request", "settings", "what-if", "results"
  std::string name;   ///< "detect.level", "training frames", "canonical.contour_error_pct.mean"
  std::string a, b;   ///< as a person reads them; "" = absent
  std::string unit;
  bool differs = false;
  std::optional<double> ratio;  ///< b / a of results, where both are finite and a is not 0
};

/// What both runs say about one light in one frame with one model.
struct ComparedError {
  std::string id;                ///< of the frame
  int frameA = -1, frameB = -1;  ///< index in each run; -1 = the run has no such frame
  std::string model, light;
  std::optional<double> errorA, errorB;  ///< mean contour error of the matched highlights, %
  std::string roleA, roleB;              ///< "training", "held out", "excluded"; "" = the run has no such frame
  std::string reasonA, reasonB;          ///< why there is no error
  std::optional<double> ratio;           ///< errorB / errorA
  bool differs = false;                  ///< errors by more than the tolerance of `replay`, or roles, or reasons
};

struct RunComparison {
  std::vector<ComparedValue> values;
  std::vector<ComparedError> errors;  ///< by model that both have, then in the order of A's frames, then those that only B has
  int framesA = 0, framesB = 0, framesCommon = 0;  ///< frames are the same when their ids are
  /// Per model that both have: over what both answer on frames held out in both.
  struct Summary {
    std::string model;
    int common = 0;
    double meanA = 0, meanB = 0;   ///< %; NaN when common is 0
    int betterA = 0, betterB = 0;  ///< answers whose error is smaller by more than the tolerance
  };
  std::vector<Summary> summaries;
  int differences() const;  ///< values and errors that differ
};

/// What changed between two runs: input files by their hashes, request, settings, what-if, and, of the models that both have,
/// results and the error of every frame.
/// @param sessionA, sessionB  of the runs, with the hashes of their files (`sessionOf`); ignores their stored results.
RunComparison compareRuns(const Session& sessionA, const Inspection& a, const Session& sessionB, const Inspection& b);

/// A plain-text report. @param all  also what is equal.
std::string comparisonText(const RunComparison& comparison, bool all);
/// Keys in docs/formats.md, "compare --json".
std::string comparisonJson(const RunComparison& comparison, const std::string& nameA, const std::string& nameB);

}  // namespace glint
