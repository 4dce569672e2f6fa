// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "core/pipeline/inspection.h"

namespace glint {

/// One candidate of the automatic choice (method.md section 11).
struct Candidate {
  std::string model;
  int views = 0;                ///< training views to leave out one at a time
  int tried = 0;                ///< of those: fewer where it cannot be the best, none where its fit to all views fails
  int answered = 0;             ///< of those, predicted, overlapping the observed contour and off by less than kNoPredictionPct
  double meanPct = 0;           ///< leave-one-view-out contour error, % of the equivalent diameter; NaN when none was answered
  double standardErrorPct = 0;  ///< of that mean; NaN with fewer than two views
  double timeUs = 0;     ///< all fits and predictions; light and canonical contours count for the first model that needed them
  double predictUs = 0;  ///< median of one prediction
  /// What the rule compares, and what it is made of, % of the diameter over the views to predict: rms of `spread` (how
  /// far the left-out fits, or the model's band, scatter) and `disagreement` (with richer models that explain training views).
  double outlookPct = std::nan(""), spreadPct = std::nan(""), disagreementPct = std::nan("");  ///< NaN where not computed
  /// Contour error to expect in the views to predict: what leaving one out shows, less the noise of the left-out contours, where
  /// they lie inside the training views; that and `outlookPct` where they lie outside. NaN where not computed.
  double expectedPct = std::nan("");
  std::string remark;  ///< "chosen", "as good as the best, but richer", the first reason of a failure, ...
};

/// Whether the chosen model may walk on local quadrics instead of the surface (`predict.query=local-quadric`).
struct PatchChoice {
  bool goodEnough = false;  ///< so predict.query may be set
  double variation = 0;     ///< largest curvatureVariation (core/model/star.h) seen; NaN when no patch could be walked
  int views = 0;            ///< left-out training views walked on patches
  int others = 0;           ///< frames to predict whose variation was looked at; of those only camera and surface are used
  double meanPct = 0;       ///< leave-one-view-out error on patches; NaN when it was not needed or not every view answered
  double predictUs = 0;     ///< of a prediction on patches, median over views; NaN when it was not needed
  double exactUs = 0;       ///< the same with exact walks
  double timeUs = 0;        ///< what finding all this out took
  std::string why;          ///< one sentence
};

struct Selection {
  std::string model;  ///< "" if no candidate answered every view that can be answered, or all expect too large an error
  bool poor = false;  ///< `model` is the best of what is there: its fit is poor, or its expected error over kLargestExpectedPct
  std::string best;   ///< what to show: `model`, or the best of those refused; "" if none answered
  std::string why;    ///< one sentence
  int trainingViews = 0;  ///< usable ones
  int leftOut = 0;        ///< of them left out, one at a time: at most kMostLeftOut, evenly spread
  int toPredict = 0;      ///< views to predict that were looked at, and of them those outside the training views
  int outside = 0;
  std::string decidedBy;               ///< "leave-one-out" or "extrapolation"; "" if nothing was chosen
  std::vector<Candidate> candidates;   ///< from simple to rich, as far as the search went
  std::optional<PatchChoice> patches;  ///< none if the chosen model does not walk, or walks on patches already

  const char* status() const { return model.empty() ? "failed" : poor ? "poor" : "ok"; }
};

/// An error as large as the highlight itself is worth no more than no prediction; a missing prediction counts as this.
inline constexpr double kNoPredictionPct = 100;
/// More views tell little about the error of the mean, and the work grows with their square.
inline constexpr int kMostLeftOut = 24;
/// Errors nearer than this are equal: a twentieth of a pixel on a highlight of 100 px. Detection alone costs more (0.08 to 0.27 %
/// on 8-bit frames, docs/accuracy.md), and a plane has a contour that is an ellipse only to about 0.02 %.
inline constexpr double kNegligiblePct = 0.05;

/// Above this expected error a choice is poor: a prediction that is off by a twentieth of its size.
inline constexpr double kLargestExpectedPct = 5;
/// Above this one no model is chosen.
inline constexpr double kLargestPoorPct = 10;
/// A simpler model may look ahead with this many times the least error: over docs/audit/auto.py's runs, where it was more, the
/// richer model did better four times out of five.
inline constexpr double kAsGood = 1.1;

/// The simplest model that is as good as the best. Uses training views, and of the views to predict the cameras, surfaces and
/// lights. Candidates are tried from simple to rich.
/// 1. Leaving one view out: a model must not be worse than the best by more than one standard error of their difference, view by
///    view (the noise of a left-out contour is the same for both), or kNegligiblePct.
/// 2. The surface must not contradict what it assumes (surface_assumption.h): `primal` needs a plane, `dual` nearly constant
///    curvature, over the training views and the views to predict. An exception: it explains the training views twice as well as
///    every model that the surface allows, by two standard errors; then the surface is what is wrong.
/// 3. Looking ahead, in views to predict: its `outlookPct` must be within kAsGood times the least. This sees what leaving one out
///    cannot: extrapolation, and differences that the noise of the left-out contours hides.
/// Errors below kNegligiblePct count as that. When the model's expected error is over kLargestExpectedPct it is not
/// chosen so. The same rules then choose among all fits, poor ones too (ModelFit::poor), under the limit kLargestPoorPct; such a
/// choice is `poor`. Above that limit nothing is chosen.
/// With `goodEnoughPct` the search stops at the first model whose leave-one-view-out error is under it, whatever it assumes;
/// where views to predict lie outside the training views, what it predicts there must be reproduced within the tolerance by its
/// left-out fits and by `limit-angle`. Nothing richer is computed.
/// Without `goodEnoughPct` it stops early only at `primal` on what is a plane as far as contours resolve; and a model that cannot
/// become as good as the best is not tried on its other views.
/// A view that one model answers and another does not counts as kNoPredictionPct for the other; one that no model answers
/// counts for none.
/// Where frames to predict show a surface that no training view shows, `primal` and `dual` are not eligible: their ellipsoid
/// belongs to the surface it was seen on.
/// Where there are views to predict, a model whose fit to all training views fails is not tried view by view, and only models
/// that can still be chosen look ahead. Lights, canonical contours and fits are computed once (core/choice/choice_ground.h).
/// Then, for a model that walks: local quadrics are good enough where the curvature varies little over the highlights of the
/// left-out views and of some frames to predict (kLargestVariation, core/model/star.h), where they answer the left-out views
/// with the same highlights and an error that the rule would still take, and are faster. Each condition is checked
/// only if those before it hold.
/// @param inspection  needs evidence and views; models need not have been fitted.
Selection selectModel(const Inspection& inspection, const std::optional<double>& goodEnoughPct, const ProgressFn& progress = {});

/// The request that computes what was chosen, or the best of what was refused: its model, and patches where they are good enough.
InspectionRequest chosenRequest(InspectionRequest request, const Selection& selection);

/// A table of the candidates and the sentence, for a person.
std::string selectionTable(const Selection& selection);

}  // namespace glint
