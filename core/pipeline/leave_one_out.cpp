// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/leave_one_out.h"

#include <algorithm>
#include <cmath>

#include "core/base/elapsed.h"
#include "core/base/number_text.h"
#include "core/light/left_out.h"
#include "core/model/plausible.h"
#include "core/pipeline/training.h"

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
  for (const PredictedHighlight& h : p.highlights)
    if (h.curvatureVariation) largest = std::fmax(largest, *h.curvatureVariation);
  return largest;
}

Answer predictLeft(const TrainingView& left, const HighlightModel& model, const ModelFit& fit, const Settings& settings) {
  Answer answer;
  const Clock::time_point start = Clock::now();
  Prediction p = model.predict(fit, left.camera, left.surface.get(), settings);
  answer.predictUs = microsecondsSince(start);
  dropTooSmall(p);
  answer.highlights = static_cast<int>(p.highlights.size());
  answer.variation = variationOf(p);
  answer.boundToSurface = fit.quadric && !model.needsCanonicalContours();
  if (p.highlights.empty()) {
    answer.failure = p.failure ? *p.failure : Failure{Reason::NotReached, "no prediction"};
    return answer;
  }
  std::vector<Polyline> predicted;
  for (const PredictedHighlight& h : p.highlights) predicted.push_back(h.contour);
  const auto pairs = matchByOverlap({left.highlight.contour}, predicted);
  if (pairs.empty()) {
    answer.failure = Failure{Reason::NotReached, "the prediction does not overlap the observed contour"};
    return answer;
  }
  const PredictedHighlight& h = p.highlights[pairs[0].second];
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

Outcome<ModelFit> fitFold(Fold& fold, const HighlightModel& model, const Settings& settings) {
  if (model.needsLight() && !fold.lightTried) {
    fold.lightTried = true;
    const Outcome<LightEstimate> light = estimateLight(fold.others, settings);
    if (light)
      fold.light = *light;
    else
      fold.lightFailure = light.failure();
  }
  if (model.needsCanonicalContours() && fold.light && !fold.canonicalTried) {
    fold.canonicalTried = true;
    for (TrainingView& v : fold.others) addCanonicalContour(v, fold.light->light, settings);
  }
  FitInput input;
  input.views = fold.others;
  input.pixelFit = fold.pixelFit;
  if (model.needsLight()) {
    input.light = fold.light;
    input.lightFailure = fold.lightFailure;
  }
  return model.fit(input, settings);
}

Answer leaveOut(Fold& fold, const HighlightModel& model, const Settings& settings) {
  const Outcome<ModelFit> fit = fitFold(fold, model, settings);
  if (!fit) return failed(fit.failure());
  Answer answer = predictLeft(*fold.left, model, *fit, settings);
  answer.fit = *fit;
  return answer;
}

std::vector<Fold> foldsOf(const Inspection& inspection, LeaveOut together) {
  const std::vector<int> places = placesOf(inspection.views);
  std::vector<int> usable;
  for (int i = 0; i < static_cast<int>(inspection.views.size()); ++i)
    if (!inspection.views[i].failure) usable.push_back(i);
  const int n = static_cast<int>(usable.size()), folds = std::min(n, kMostLeftOut);
  std::vector<Fold> all;
  for (int f = 0; f < folds; ++f) {
    Fold fold;
    const auto left = static_cast<std::size_t>(usable[static_cast<std::size_t>(f) * n / folds]);
    fold.left = &inspection.views[left];
    // The whole frame is left out: another highlight in it has seen the same camera and the same errors.
    for (std::size_t i = 0; i < inspection.views.size(); ++i) {
      const TrainingView& v = inspection.views[i];
      if (together == LeaveOut::Place && places[i] == places[left]) continue;
      if (v.failure || v.frame == fold.left->frame || v.highlight.light != fold.left->highlight.light) continue;
      if (inspection.train.perSurface && inspection.surfaces->keyOf(v.frame) != inspection.surfaces->keyOf(fold.left->frame))
        continue;
      fold.others.push_back(v);
      fold.others.back().canonical.reset();
    }
    all.push_back(std::move(fold));
  }
  return all;
}

}  // namespace glint
