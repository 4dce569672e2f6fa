// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// What the automatic choice learns from views that are to be predicted: their cameras, surfaces and stated lights are used,
// nothing that was observed in them.

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/choice/leave_one_out.h"

namespace glint {

/// One light in one frame that is to be predicted.
struct ViewToPredict {
  int frame = -1;
  std::string light;
  Camera camera;
  std::shared_ptr<const Surface> surface;
  double distanceDeg = 0;  ///< to the nearest training view, see `viewsToPredict`
  double testedDeg = 0;    ///< the farthest that leaving one out has tested, by the same measure
  bool outside = false;    ///< so leaving one out says nothing about it
};

/// Held-out frames that do not train, at most `most` of them, evenly spread, with each light that training views show and that is
/// on there. The distance of two views is the angle between their cameras as seen from the training highlights, combined with the
/// logarithm of their distances' ratio (as an angle in radians). A view lies outside where it is more than 1.5 times as far from
/// the nearest training view as any left-out view was from the nearest of the others, or shows a surface that no training view
/// shows.
std::vector<ViewToPredict> viewsToPredict(const Inspection& inspection, const std::vector<Fold>& folds, std::size_t most);

/// All training views of every light, by light: what the chosen model is fitted to. `left` is the first of them.
std::map<std::string, Fold> wholeFolds(const Inspection& inspection, const std::vector<Fold>& folds);

/// With fewer training views, leaving one out tells about fits of too few views.
inline constexpr int kFewViews = 4;

/// What one model predicts in the views to predict.
struct Outlook {
  std::map<std::string, Outcome<ModelFit>> fits;             ///< by light, to all training views
  std::vector<std::vector<PredictedHighlight>> predictions;  ///< one entry per view, of these fits; empty without one
  /// By view, % of the diameter: the jackknife's standard error of the prediction, sqrt(n - 1) times the root mean square
  /// distance between the contours of the left-out fits and that of the fit to all n views. With fewer than kFewViews views, or
  /// where most left-out fits failed, the mean absolute distance that the model's own band (HighlightModel::bandSigmaPx) expects,
  /// if it has one. kNoPredictionPct where neither is known; at most that.
  std::vector<double> spreadPct;
  double timeUs = 0;
};

/// @param fits  by light, to all views of `whole`. @param answers  one per fold, with their fits.
Outlook lookAhead(const HighlightModel& model, std::map<std::string, Outcome<ModelFit>> fits,
                  const std::map<std::string, Fold>& whole, const std::vector<Fold>& folds, const std::vector<Answer>& answers,
                  const std::vector<ViewToPredict>& views, const Settings& settings, const ProgressFn& progress);

/// Distance between two predictions of one view as `contour_error_pct` (method.md section 10), of the first one's diameter; a
/// highlight that only one of them has counts kNoPredictionPct, and no pair counts more. NaN when neither has one.
double differencePct(const std::vector<PredictedHighlight>& a, const std::vector<PredictedHighlight>& b);

/// What the noise of an observed contour adds to its distance from the true one, % of its equivalent diameter: the distance from
/// its own eight lowest harmonics, by the same measure. 0 for open contours and for fewer than 48 points, which tell too little.
double contourNoisePct(const Polyline& observed);

}  // namespace glint
