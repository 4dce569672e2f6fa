// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/choice/selection.h"
#include "core/model/plausible.h"
#include "core/pipeline/fit_engine.h"

namespace glint {

/// One left-out training view and what the others give without it. Light and canonical contours are filled by the first model
/// that needs them and serve all that follow.
struct Fold {
  const Inspection* inspection = nullptr;
  TrainingView left;                 ///< on its surface as given
  std::vector<TrainingView> others;  ///< likewise
  std::optional<LightFit> light;     ///< of the others, with their own correction of the surface
  bool canonicalTried = false;
  std::shared_ptr<const Surface> leftSurface;  ///< of the left-out view, corrected by what the others say
  KnownPixels pixels;                          ///< what the fit to the pixels of all views has said
  KnownPixels onSmoothed;                      ///< the same on the mesh that all views smooth
  /// Those made, by model, poor ones too. They are of one choice of settings.
  std::map<std::string, Outcome<ModelFit>> fits;
  /// The surface on which a model predicts in some frame. The failures of correctedSurface().
  Outcome<std::shared_ptr<const Surface>> surfaceOf(int frame, const HighlightModel& model) const;
};

/// A model's answer for one left-out view.
struct Answer {
  std::optional<double> errorPct;
  std::optional<Failure> failure;
  double predictUs = 0;
  std::optional<ModelFit> fit;
  int highlights = 0;           ///< predicted
  double coverage = 0;          ///< of the one that was compared
  double variation = 0;         ///< the largest of all; NaN when nothing was walked on a patch
  bool boundToSurface = false;  ///< an ellipsoid of the highlight as it was seen, without the walk that takes the surface out
  /// The error as it counts in the ranking.
  double countedPct() const { return errorPct ? *errorPct : kNoPredictionPct; }
};

/// What is left out with a training view: its frame, or every frame from its place (core/light/left_out.h). A view from the same
/// place would tell a model the answer; to see what one frame changes, that view must stay.
enum class LeaveOut { Frame, Place };
/// One per left-out view: at most kMostLeftOut, evenly spread. Valid as long as the inspection.
std::vector<Fold> foldsOf(const Inspection& inspection, LeaveOut together);
/// The correction is the smoothed mesh and nothing else.
bool isSmoothedAlone(const SurfaceCorrection& correction);
/// Fits of reflectance look at pixels.
bool fitsPixels(const Settings& settings);
/// The fit of the model to the fold's other views, made once. Fills what is missing in the fold. The model's and the light's
/// failures; NotConverged for a poor fit where those do not serve.
Outcome<ModelFit> fitFold(Fold& fold, const HighlightModel& model, const Settings& settings, PoorFits poor = PoorFits::Refuse,
                          const ProgressFn& progress = {});
/// Fits the model to the other views, predicts the left-out one and compares. Fills what is missing in the fold.
Answer leaveOut(Fold& fold, const HighlightModel& model, const Settings& settings, PoorFits poor = PoorFits::Refuse,
                const ProgressFn& progress = {});
/// Poor fits serve to judge a model where one of its own fits is poor.
PoorFits poorFitsFor(const ModelResult& result);
/// The last step of leaveOut() alone, from an existing fit.
Answer predictLeft(const Fold& fold, const HighlightModel& model, const ModelFit& fit, const Settings& settings);

/// What is known when a model is tried: once it can no longer become the best, its other views need not be tried.
struct RankingSoFar {
  std::vector<char> possible;  ///< by fold: some model answered it
  /// Smallest ranked error of an eligible model, over the possible folds, with the tolerance of others.
  double best = std::numeric_limits<double>::infinity();
};
/// Leaves out every fold in turn, as long as the model can become the best. @param answers  gets one per fold
Candidate tryModel(const Inspection& inspection, const HighlightModel& model, std::vector<Fold>& folds,
                   std::vector<Answer>& answers, const RankingSoFar& known, PoorFits poor, const ProgressFn& progress);
/// Mean over the views that any model answers; NaN without any.
double rankedPct(const std::vector<Answer>& answers, const std::vector<char>& possible);
/// How much worse one model is than another, view by view.
struct ExcessError {
  double mean = 0, standardError = 0;  ///< %
};
ExcessError excessOf(const std::vector<Answer>& a, const std::vector<Answer>& b, const std::vector<char>& possible);

/// The largest curvatureVariation of the highlights; NaN when none was walked on a patch.
double variationOf(const Prediction& prediction);

/// Whether local quadrics serve the model that was chosen. None if it does not walk or walks on them already.
/// @param exact    one answer per fold, of exact walks.
/// @param mostPct  the error that the rule would still take.
std::optional<PatchChoice> choosePatches(const Inspection& inspection, const HighlightModel& model,
                                         const std::vector<Fold>& folds, const std::vector<Answer>& exact, double mostPct,
                                         const ProgressFn& progress);

/// "0.123 %".
std::string percentText(double v);

}  // namespace glint
