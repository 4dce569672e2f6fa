// SPDX-License-Identifier: BSD-3-Clause
#include "core/selection/leave_one_out.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/elapsed.h"
#include "core/base/number_text.h"
#include "core/fit/training.h"
#include "core/light/left_out.h"
#include "core/model/plausible.h"
#include "core/surface/mesh_policy.h"

namespace glint {

namespace {
Answer failed(Failure failure) {
  Answer a;
  a.failure = std::move(failure);
  a.predictUs = a.variation = std::nan("");
  return a;
}
}  // namespace

std::string percentText(double v) { return formatted("%.3g %%", v); }

double variationOf(const Prediction& p) {
  double largest = std::nan("");
  for (const PredictedHighlight& h : p.highlights())
    if (h.curvatureVariation) largest = std::fmax(largest, *h.curvatureVariation);
  return largest;
}

Answer predictLeft(const Fold& fold, const HighlightModel& model, const ModelFit& fit, const Settings& settings) {
  Answer answer;
  const TrainingView& left = fold.left;
  const Clock::time_point start = Clock::now();
  Prediction p = model.predict(fit, left.camera, fold.leftSurface.get(), settings);
  answer.predictUs = microsecondsSince(start);
  dropTooSmall(p);
  answer.highlights = static_cast<int>(p.highlights().size());
  answer.variation = variationOf(p);
  answer.boundToSurface = fit.as<EllipsoidFit>() && !model.needsCanonicalContours();
  if (p.highlights().empty()) {
    answer.failure = p.failure() ? *p.failure() : Failure{Reason::NotReached, "no prediction"};
    return answer;
  }
  std::vector<Polyline> predicted;
  for (const PredictedHighlight& h : p.highlights()) predicted.push_back(h.contour);
  const auto pairs = matchByOverlap({left.highlight.contour}, predicted);
  if (pairs.empty()) {
    answer.failure = Failure{Reason::NotReached, "the prediction does not overlap the observed contour"};
    return answer;
  }
  const PredictedHighlight& h = p.highlights()[pairs[0].second];
  answer.coverage = h.coverage;
  const ContourMetrics m =
      compareContours(left.highlight.contour, h.contour, h.gaps, h.ellipse, left.highlight.peak, h.brightest.pixel);
  if (!std::isfinite(m.contourErrorPct))
    answer.failure = Failure{Reason::NotFinite, "contour error"};
  else if (m.contourErrorPct > kNoPredictionPct)
    answer.failure = Failure{Reason::NotReached, "the predicted contour is off by " + percentText(m.contourErrorPct)};
  else
    answer.errorPct = m.contourErrorPct;
  return answer;
}

Outcome<std::shared_ptr<const Surface>> Fold::surfaceOf(int frame, const HighlightModel& model) const {
  const SurfaceCorrection none;
  return correctedSurface(*inspection->scene, *inspection->surfaces, frame,
                          model.needsLight() && light ? light->correction : none, meshPolicy(inspection->request.settings));
}

Outcome<ModelFit> fitFold(Fold& fold, const HighlightModel& model, const Settings& settings) {
  if (!model.needsLight()) return fitModel(model, fold.others, std::nullopt, settings, fold.pixelFit);
  if (!fold.light) {
    fold.light = fitLight(fold.others, *fold.inspection->scene, *fold.inspection->surfaces, settings);
    if (fold.light->correction) {
      const Outcome<std::shared_ptr<const Surface>> surface = fold.surfaceOf(fold.left.frame, model);
      fold.leftSurface = surface ? *surface : nullptr;
    }
  }
  if (model.needsCanonicalContours() && fold.light->light && !std::exchange(fold.canonicalTried, true))
    for (TrainingView& v : fold.light->views) addCanonicalContour(v, fold.light->light->light, settings);
  return fitModel(model, fold.light->views, fold.light->light, settings, fold.light->correction ? nullptr : fold.pixelFit);
}

Answer leaveOut(Fold& fold, const HighlightModel& model, const Settings& settings) {
  const Outcome<ModelFit> fit = fitFold(fold, model, settings);
  if (!fit) return failed(fit.failure());
  Answer answer = predictLeft(fold, model, *fit, settings);
  answer.fit = *fit;
  return answer;
}

std::vector<Fold> foldsOf(const Inspection& inspection, LeaveOut together) {
  const std::vector<int> places = placesOf(inspection.views);
  std::vector<int> usable;
  for (int i = 0; i < static_cast<int>(inspection.views.size()); ++i)
    if (inspection.views[i].seen) usable.push_back(i);
  const int n = static_cast<int>(usable.size()), folds = std::min(n, kMostLeftOut);
  std::vector<Fold> all;
  for (int f = 0; f < folds; ++f) {
    Fold fold;
    const auto left = static_cast<std::size_t>(usable[static_cast<std::size_t>(f) * n / folds]);
    fold.inspection = &inspection;
    fold.left = inspection.viewAsGiven(static_cast<int>(left));
    fold.leftSurface = fold.left.surface;
    const FitKey key = inspection.keyFor(fold.left.frame, fold.left.highlight.light);
    // The whole frame is left out: another highlight in it has seen the same camera and the same errors.
    for (std::size_t i = 0; i < inspection.views.size(); ++i) {
      const TrainingView& v = inspection.views[i];
      if (together == LeaveOut::Place && places[i] == places[left]) continue;
      if (!v.seen || v.frame == fold.left.frame || inspection.keyFor(v.frame, v.highlight.light) != key) continue;
      fold.others.push_back(inspection.viewAsGiven(static_cast<int>(i)));
    }
    all.push_back(std::move(fold));
  }
  return all;
}

}  // namespace glint
