// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "core/inspect/inspection.h"

namespace glint {

/// Contour errors of one model in views that its fit did not see: left-out training views, or held-out frames.
struct LeftOutError {
  struct View {
    int frame = -1;
    std::string light;
    bool training = true;   ///< else of a held-out frame
    double pct = 0;         ///< of the equivalent diameter; kNoPredictionPct where there is no prediction
    double radiusPx = 0;    ///< of the observed highlight
    bool answered = false;  ///< predicted, overlapping the observed contour and off by less than kNoPredictionPct
  };
  std::vector<View> views;
  std::string firstFailure;  ///< of a view that was not answered, with its frame; "" where all were
  int answered() const;
  /// Mean of the views, unanswered ones as kNoPredictionPct; NaN without a view.
  double meanPct() const;
};

/// Leaves out the training views of one place at a time (core/selection/leave_one_out.h), fits the model to the others and predicts them.
/// @param inspection  with evidence and views; its models need not have been fitted
LeftOutError leftOutError(const Inspection& inspection, const HighlightModel& model, const ProgressFn& progress);

/// The same, followed by the highlights of held-out frames, which the fit to all training views predicts. A view is then measured by a fit that
/// did not see it whether it trains or not, so that two choices of training frames can be compared.
/// @param evidence  inspection whose evidence of the held-out frames is used, on the same scene
/// @param frames    looked at where they do not train
LeftOutError unseenError(const Inspection& inspection, const Inspection& evidence, const std::vector<int>& frames,
                         const HighlightModel& model, const ProgressFn& progress);

/// At most `most` frames with highlights that are not excluded, evenly spread over the sequence.
std::vector<int> spreadFrames(const Inspection& inspection, int most);

/// Those of the training views alone, or of the held-out frames alone.
LeftOutError ofTraining(const LeftOutError& error, bool training);

/// Off by more than kLargestExpectedPct, or not answered.
bool isAstray(const LeftOutError::View& view);

/// Whether the second is better than the first beyond chance: over the views of both by more than one standard error of the difference, and by
/// a tenth; more than kNegligiblePct; or where fewer views are off by more than kLargestExpectedPct and no other one is. Where they share fewer
/// than two views, by the means of all and a tenth.
bool isBetter(const LeftOutError& after, const LeftOutError& before);

/// Of the first, those views that the second has as well; all of them where that is none.
LeftOutError commonViews(const LeftOutError& of, const LeftOutError& with);

}  // namespace glint
