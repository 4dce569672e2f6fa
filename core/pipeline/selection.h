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
  int views = 0;                ///< training views left out one at a time
  int answered = 0;             ///< of those, predicted and overlapping the observed contour
  double meanPct = 0;           ///< leave-one-view-out contour error, % of the equivalent diameter; NaN when none was answered
  double standardErrorPct = 0;  ///< of that mean; NaN with fewer than two views
  double timeUs = 0;     ///< all fits and predictions; light and canonical contours count for the first model that needed them
  double predictUs = 0;  ///< median of one prediction
  std::string remark;    ///< "chosen", "as good as the best, but richer", the first reason of a failure, ...
};

struct Selection {
  std::string model;                  ///< "" when no candidate answered every view that can be answered
  std::string why;                    ///< one sentence
  int trainingViews = 0;              ///< usable ones
  int leftOut = 0;                    ///< of them left out, one at a time: at most kMostLeftOut, evenly spread
  std::vector<Candidate> candidates;  ///< from simple to rich, as far as the search went
};

/// Beyond this the error of the mean says enough, and the work would grow with the square of the views.
inline constexpr int kMostLeftOut = 24;
/// Errors nearer than this are equal: a twentieth of a pixel on a highlight of 100 px. Detection alone costs more (0.08 to 0.27 %
/// on 8-bit frames, docs/accuracy.md), and a plane has a contour that is an ellipse only to about 0.02 %.
inline constexpr double kNegligiblePct = 0.05;

/// The simplest model whose leave-one-view-out contour error is within one standard error of the best (or within
/// kNegligiblePct), or under `goodEnoughPct` when that is given. Uses training views only. Candidates are tried from simple to
/// rich; with a tolerance the search stops at the first that meets it: nothing richer is computed. A view that no model
/// answers counts against none; without a tolerance a model must answer every view that another one does.
/// Leaving views out cannot tell how a model does on a surface that no training view shows. Where frames to predict show one,
/// `primal` and `dual` are not eligible: their ellipsoid belongs to the surface it was seen on.
/// The light and the canonical contours without a view are computed once for all models that need them.
/// @param inspection  needs evidence and views; models need not have been fitted.
Selection selectModel(const Inspection& inspection, const std::optional<double>& goodEnoughPct, const ProgressFn& progress = {});

/// A table of the candidates and the sentence, for a person.
std::string selectionTable(const Selection& selection);

}  // namespace glint
