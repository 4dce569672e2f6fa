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
  int views = 0;                ///< training views to leave out one at a time
  int tried = 0;                ///< of those: fewer than `views` where it was clear that the model cannot be the best
  int answered = 0;             ///< of those, predicted, overlapping the observed contour and off by less than kNoPredictionPct
  double meanPct = 0;           ///< leave-one-view-out contour error, % of the equivalent diameter; NaN when none was answered
  double standardErrorPct = 0;  ///< of that mean; NaN with fewer than two views
  double timeUs = 0;     ///< all fits and predictions; light and canonical contours count for the first model that needed them
  double predictUs = 0;  ///< median of one prediction
  std::string remark;    ///< "chosen", "as good as the best, but richer", the first reason of a failure, ...
};

/// Whether the chosen model may walk on local quadrics instead of the surface (`predict.query=local-quadric`).
struct PatchChoice {
  bool goodEnough = false;      ///< so predict.query may be set
  double variation = 0;         ///< largest curvatureVariation (core/model/star.h) seen; NaN when no patch could be walked
  int views = 0;                ///< left-out training views walked on patches
  int others = 0;               ///< frames to predict whose variation was looked at; of those only camera and surface are used
  double meanPct = 0;           ///< leave-one-view-out error on patches; NaN when it was not needed or not every view answered
  double predictUs = 0;         ///< of a prediction on patches, median over views; NaN when it was not needed
  double exactUs = 0;           ///< the same with exact walks
  double timeUs = 0;            ///< what finding all this out took
  std::string why;              ///< one sentence
};

struct Selection {
  std::string model;                  ///< "" when no candidate answered every view that can be answered
  std::string why;                    ///< one sentence
  int trainingViews = 0;              ///< usable ones
  int leftOut = 0;                    ///< of them left out, one at a time: at most kMostLeftOut, evenly spread
  std::vector<Candidate> candidates;  ///< from simple to rich, as far as the search went
  std::optional<PatchChoice> patches; ///< none when the chosen model does not walk, or walks on patches already
};

/// An error as large as the highlight itself is worth no more than no prediction; a missing prediction counts as this.
inline constexpr double kNoPredictionPct = 100;
/// Beyond this the error of the mean says enough, and the work would grow with the square of the views.
inline constexpr int kMostLeftOut = 24;
/// Errors nearer than this are equal: a twentieth of a pixel on a highlight of 100 px. Detection alone costs more (0.08 to 0.27 %
/// on 8-bit frames, docs/accuracy.md), and a plane has a contour that is an ellipse only to about 0.02 %.
inline constexpr double kNegligiblePct = 0.05;

/// The simplest model whose leave-one-view-out contour error is within one standard error of the best (or within
/// kNegligiblePct), or under `goodEnoughPct` when that is given. Uses training views only. Candidates are tried from simple to
/// rich; with a tolerance the search stops at the first that meets it: nothing richer is computed. Without one it stops where the
/// error is below kNegligiblePct, because nothing can then be better by more than that; and a model that cannot become the
/// best any more is not tried on its other views.
/// A view that one model answers and another does not counts as kNoPredictionPct for the other; one that no model answers
/// counts for none.
/// Leaving views out cannot tell how a model does on a surface that no training view shows. Where frames to predict show one,
/// `primal` and `dual` are not eligible: their ellipsoid belongs to the surface it was seen on.
/// The light and the canonical contours without a view are computed once for all models that need them.
/// Then, for a model that walks: local quadrics are good enough where the curvature varies little over the highlights of the
/// left-out views and of some frames to predict (kLargestVariation, core/model/star.h), where they answer the left-out views
/// with the same highlights and an error that the rule would still take, and where they are faster. Each question is asked
/// only when those before it are answered by yes.
/// @param inspection  needs evidence and views; models need not have been fitted.
Selection selectModel(const Inspection& inspection, const std::optional<double>& goodEnoughPct, const ProgressFn& progress = {});

/// The request that computes what was chosen: its model, and patches where they are good enough.
InspectionRequest chosenRequest(InspectionRequest request, const Selection& selection);

/// A table of the candidates and the sentence, for a person.
std::string selectionTable(const Selection& selection);

}  // namespace glint
