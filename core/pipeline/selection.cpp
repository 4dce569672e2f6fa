// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/selection.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>

#include "core/pipeline/training.h"

namespace glint {
namespace {

std::string percent(double v) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.3g %%", v);
  return buffer;
}

/// Contour error of one left-out view, or why there is none.
Outcome<double> leftOutError(const Inspection& inspection, const HighlightModel& model, std::vector<TrainingView> others,
                             const TrainingView& left) {
  const Settings& settings = inspection.request.settings;
  FitInput input;
  if (model.needsLight()) {
    const Outcome<LightEstimate> light = estimateLight(others, settings);
    if (light) {
      input.light = *light;
      if (model.needsCanonicalContours())
        for (TrainingView& v : others) addCanonicalContour(v, light->light, settings);
    } else {
      input.lightFailure = light.failure();
    }
  }
  input.views = std::move(others);
  const Outcome<ModelFit> fit = model.fit(input, settings);
  if (!fit) return fit.failure();
  const Prediction p = model.predict(*fit, left.camera, left.surface.get(), settings);
  if (p.highlights.empty()) return p.failure ? *p.failure : Failure{Reason::NotReached, "no prediction"};
  std::vector<Polyline> predicted;
  for (const PredictedHighlight& h : p.highlights) predicted.push_back(h.contour);
  const auto pairs = matchByOverlap({left.highlight.contour}, predicted);
  if (pairs.empty()) return Failure{Reason::NotReached, "the prediction does not overlap the observed contour"};
  const PredictedHighlight& h = p.highlights[pairs[0].second];
  const ContourMetrics m =
      compareContours(left.highlight.contour, h.contour, h.gaps, h.ellipse, left.highlight.peak, h.brightest.pixel);
  if (!std::isfinite(m.contourErrorPct)) return Failure{Reason::NotFinite, "contour error"};
  return m.contourErrorPct;
}

Candidate tryModel(const Inspection& inspection, const HighlightModel& model, const ProgressFn& progress) {
  Candidate c;
  c.model = model.id();
  std::vector<double> errors;
  const auto start = std::chrono::steady_clock::now();
  const int n = static_cast<int>(inspection.views.size());
  for (int i = 0; i < n; ++i) {
    if (!report(progress, {"leave one out " + c.model, i, n})) throw Stopped{};
    const TrainingView& left = inspection.views[i];
    if (left.failure) continue;
    ++c.views;
    std::vector<TrainingView> others;
    for (const TrainingView& v : inspection.views) {
      if (v.frame == left.frame || v.highlight.light != left.highlight.light) continue;
      if (inspection.train.perSurface && inspection.surfaces->keyOf(v.frame) != inspection.surfaces->keyOf(left.frame)) continue;
      others.push_back(v);
    }
    const Outcome<double> error = leftOutError(inspection, model, std::move(others), left);
    if (error) errors.push_back(*error);
    else if (c.remark.empty()) c.remark = "without frame " + std::to_string(left.frame) + ": " + error.failure().message();
  }
  c.timeUs = std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count();
  c.answered = static_cast<int>(errors.size());
  double sum = 0, squares = 0;
  for (const double e : errors) sum += e;
  c.meanPct = errors.empty() ? std::nan("") : sum / double(errors.size());
  for (const double e : errors) squares += (e - c.meanPct) * (e - c.meanPct);
  c.standardErrorPct = errors.size() > 1 ? std::sqrt(squares / double(errors.size() - 1) / double(errors.size())) : std::nan("");
  return c;
}

}  // namespace

Selection selectModel(const Inspection& inspection, const std::optional<double>& goodEnoughPct, const ProgressFn& progress) {
  Selection s;
  for (const auto& model : allModels()) {
    s.candidates.push_back(tryModel(inspection, *model, progress));
    Candidate& c = s.candidates.back();
    if (goodEnoughPct && c.views > 0 && c.answered == c.views && c.meanPct <= *goodEnoughPct) {
      c.remark = "chosen";
      s.model = c.model;
      s.why = "The simplest model under the stated tolerance of " + percent(*goodEnoughPct) + ": " + c.model + " has " +
              percent(c.meanPct) + " leaving one view out; richer models were not tried.";
      return s;
    }
  }
  const Candidate* best = nullptr;
  for (const Candidate& c : s.candidates)
    if (c.views > 0 && c.answered == c.views && (!best || c.meanPct < best->meanPct)) best = &c;
  if (!best) {
    s.why = "No model predicted every left-out training view.";
    return s;
  }
  const double slack = std::isfinite(best->standardErrorPct) ? best->standardErrorPct : 0;
  const std::string bestName = best->model;
  const double limit = best->meanPct + slack;
  for (Candidate& c : s.candidates) {
    if (!(c.views > 0 && c.answered == c.views && c.meanPct <= limit)) continue;
    c.remark = "chosen";
    s.model = c.model;
    s.why = (c.model == bestName
                 ? "It has the smallest leave-one-view-out error (" + percent(c.meanPct) + "), and no simpler model is within its standard error (" + percent(slack) + ")."
                 : "The simplest model within one standard error (" + percent(slack) + ") of the best: " + c.model + " has " +
                       percent(c.meanPct) + ", the best is " + bestName + " with " + percent(limit - slack) + ".");
    break;
  }
  if (goodEnoughPct) s.why += " No model reached the stated tolerance of " + percent(*goodEnoughPct) + ".";
  return s;
}

}  // namespace glint
