// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "core/pipeline/inspection.h"

namespace glint {

/// A model's error, with its settings and training frames, in views that its fit did not see: the held-out frames, as in every
/// table of errors. If none shows a highlight: training views, each predicted by a fit without its place (core/choice).
struct UnseenError {
  /// One light in one frame.
  struct View {
    int frame = -1;
    std::string light;
    int matched = 0, missed = 0, spurious = 0;  ///< highlights
    double contourPct = 0;                      ///< sum of the matched ones' contour errors, % of the equivalent diameter
    double wrongPct = 0;                        ///< ComparisonTally::wrongPct(): what is summed to compare one state with another
    int observed() const { return matched + missed; }
    bool operator==(const View&) const = default;
  };
  std::vector<View> views;
  bool leftOut = false;  ///< of training views
  /// One number that orders all states: wrongPct per observed highlight. 0 = perfect; the mean contour error where nothing is
  /// missed or spurious; 100 where nothing is predicted. NaN where nothing was observed.
  double pct() const;
  double contourPct() const;  ///< mean of the matched highlights; NaN where none was
  int matched() const { return sum(&View::matched); }
  int missed() const { return sum(&View::missed); }
  int spurious() const { return sum(&View::spurious); }
  int observed() const { return matched() + missed(); }

 private:
  int sum(int View::*count) const;
};

/// @param inspection  complete, with this model. Stopped.
UnseenError unseenError(const Inspection& inspection, const std::string& model, const ProgressFn& progress);

/// Whether the second is better than the first: with a tenth fewer spurious highlights where its contours are no worse and it
/// misses no more; or beyond chance. That is, over the views of both: by more than kNegligiblePct, by a tenth, and by more than
/// one standard error of the difference, or with fewer wrong views and no new one. They must be half of what is scored
/// before, and over all of its views the second must not be worse: what the user then sees is no larger number.
bool isBetter(const UnseenError& after, const UnseenError& before);

/// An observed highlight is missed, or off by more than kLargestExpectedPct.
bool isAstray(const UnseenError::View& view);

/// The views of the first error that the second has as well.
UnseenError commonViews(const UnseenError& of, const UnseenError& with);

/// "0.74 %, 2 of 54 highlights missed, 24 spurious"; "no highlight predicted".
std::string textOf(const UnseenError& error);

}  // namespace glint
