// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/selection.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <set>

#include "core/base/parallel.h"
#include "core/evaluate/summary.h"
#include "core/pipeline/training.h"

namespace glint {
namespace {

using Clock = std::chrono::steady_clock;

double microsecondsSince(Clock::time_point start) {
  return std::chrono::duration<double, std::micro>(Clock::now() - start).count();
}

std::string percent(double v) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.3g %%", v);
  return buffer;
}

/// One left-out view and what the others give without it. Light and canonical contours are filled by the first model that
/// needs them and serve all that follow.
struct Fold {
  const TrainingView* left = nullptr;
  std::vector<TrainingView> others;
  bool lightTried = false, canonicalTried = false;
  std::optional<LightEstimate> light;
  std::optional<Failure> lightFailure;
};

struct Answer {
  std::optional<double> errorPct;
  std::optional<Failure> failure;
  double predictUs = 0;
  bool boundToSurface = false;  ///< an ellipsoid of the highlight as it was seen, without the walk that takes the surface out
};

Answer failed(Failure failure) { return {std::nullopt, std::move(failure), std::nan(""), false}; }

/// Contour error of the left-out view, or why there is none.
Answer leaveOut(Fold& fold, const HighlightModel& model, const Settings& settings) {
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
  if (model.needsLight()) {
    input.light = fold.light;
    input.lightFailure = fold.lightFailure;
  }
  const Outcome<ModelFit> fit = model.fit(input, settings);
  if (!fit) return failed(fit.failure());
  const TrainingView& left = *fold.left;
  const Clock::time_point start = Clock::now();
  const Prediction p = model.predict(*fit, left.camera, left.surface.get(), settings);
  Answer answer{std::nullopt, std::nullopt, microsecondsSince(start), fit->quadric && !model.needsCanonicalContours()};
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
  const ContourMetrics m =
      compareContours(left.highlight.contour, h.contour, h.gaps, h.ellipse, left.highlight.peak, h.brightest.pixel);
  if (std::isfinite(m.contourErrorPct))
    answer.errorPct = m.contourErrorPct;
  else
    answer.failure = Failure{Reason::NotFinite, "contour error"};
  return answer;
}

std::vector<Fold> foldsOf(const Inspection& inspection) {
  std::vector<int> usable;
  for (int i = 0; i < static_cast<int>(inspection.views.size()); ++i)
    if (!inspection.views[i].failure) usable.push_back(i);
  const int n = static_cast<int>(usable.size()), folds = std::min(n, kMostLeftOut);
  std::vector<Fold> all;
  for (int f = 0; f < folds; ++f) {
    Fold fold;
    fold.left = &inspection.views[usable[static_cast<std::size_t>(f) * n / folds]];
    // The whole frame is left out: another highlight in it has seen the same camera and the same errors.
    for (const TrainingView& v : inspection.views) {
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

/// A frame that is to be predicted shows a surface of the scene file that no training view shows. Depth maps are one object seen
/// from many sides, so they do not count.
bool predictsOtherSurfaces(const Inspection& inspection) {
  if (inspection.train.perSurface) return false;
  std::set<std::string> seen;
  const std::vector<Frame>& frames = inspection.scene->frames;
  for (const TrainingView& v : inspection.views) seen.insert(frames[v.frame].surface);
  for (int f = 0; f < static_cast<int>(frames.size()); ++f)
    if (inspection.isHeldOut(f) && !frames[f].surface.empty() && !seen.count(frames[f].surface)) return true;
  return false;
}

Candidate tryModel(const Inspection& inspection, const HighlightModel& model, std::vector<Fold>& folds,
                   std::vector<Answer>& answers, const ProgressFn& progress) {
  Candidate c;
  c.model = model.id();
  c.views = static_cast<int>(folds.size());
  answers.assign(folds.size(), {});
  const Clock::time_point start = Clock::now();
  parallelFor(
      c.views, [&](int i) { answers[i] = leaveOut(folds[i], model, inspection.request.settings); }, progress,
      "leave one out " + c.model);
  c.timeUs = microsecondsSince(start);
  std::vector<double> errors, times;
  for (std::size_t i = 0; i < answers.size(); ++i) {
    if (answers[i].errorPct) {
      errors.push_back(*answers[i].errorPct);
      times.push_back(answers[i].predictUs);
    } else if (c.remark.empty()) {
      c.remark = "without frame " + inspection.scene->frames[folds[i].left->frame].id + ": " + answers[i].failure->message();
    }
  }
  c.answered = static_cast<int>(errors.size());
  double sum = 0, squares = 0;
  for (const double e : errors) sum += e;
  c.meanPct = errors.empty() ? std::nan("") : sum / double(errors.size());
  for (const double e : errors) squares += (e - c.meanPct) * (e - c.meanPct);
  c.standardErrorPct = errors.size() > 1 ? std::sqrt(squares / double(errors.size() - 1) / double(errors.size())) : std::nan("");
  c.predictUs = statisticOf(times).median;
  return c;
}

}  // namespace

Selection selectModel(const Inspection& inspection, const std::optional<double>& goodEnoughPct, const ProgressFn& progress) {
  Selection s;
  std::vector<Fold> folds = foldsOf(inspection);
  s.leftOut = static_cast<int>(folds.size());
  for (const TrainingView& v : inspection.views) s.trainingViews += v.failure ? 0 : 1;
  std::vector<std::vector<Answer>> answers;
  const bool otherSurfaces = predictsOtherSurfaces(inspection);
  std::vector<char> bound;
  for (const auto& model : allModels()) {
    s.candidates.push_back(tryModel(inspection, *model, folds, answers.emplace_back(), progress));
    Candidate& c = s.candidates.back();
    bound.push_back(otherSurfaces &&
                    std::any_of(answers.back().begin(), answers.back().end(), [](const Answer& a) { return a.boundToSurface; }));
    if (bound.back()) {
      c.remark =
          "not eligible: frames to predict show surfaces that no training view shows, and its ellipsoid belongs to the surface "
          "it was seen on";
      continue;
    }
    if (goodEnoughPct && c.views > 0 && c.answered == c.views && c.meanPct <= *goodEnoughPct) {
      c.remark = "chosen";
      s.model = c.model;
      s.why = "The simplest model under the stated tolerance of " + percent(*goodEnoughPct) + ": " + c.model + " has " +
              percent(c.meanPct) + " leaving one view out; richer models were not tried.";
      return s;
    }
  }
  // A view that nothing answers tells nothing about the models.
  const auto complete = [&](std::size_t m) {
    if (bound[m]) return false;
    for (std::size_t i = 0; i < folds.size(); ++i) {
      const bool possible =
          std::any_of(answers.begin(), answers.end(), [&](const std::vector<Answer>& a) { return a[i].errorPct.has_value(); });
      if (possible && !answers[m][i].errorPct) return false;
    }
    return s.candidates[m].answered > 0;
  };
  int best = -1;
  for (std::size_t m = 0; m < s.candidates.size(); ++m)
    if (complete(m) && (best < 0 || s.candidates[m].meanPct < s.candidates[best].meanPct)) best = static_cast<int>(m);
  if (best < 0) {
    s.why = s.leftOut == 0 ? "There is no training view to leave out."
                           : "No model predicted every left-out training view that another one did.";
    return s;
  }
  const Candidate winner = s.candidates[best];
  const double slack = std::max(kNegligiblePct, std::isfinite(winner.standardErrorPct) ? winner.standardErrorPct : 0);
  const std::string slackText = slack > kNegligiblePct ? "one standard error (" + percent(slack) + ")"
                                                       : "what contours resolve (" + percent(kNegligiblePct) + ")";
  for (std::size_t m = 0; m < s.candidates.size(); ++m) {
    Candidate& c = s.candidates[m];
    if (!complete(m)) continue;
    if (c.meanPct > winner.meanPct + slack) {
      c.remark = "worse than the best by " + percent(c.meanPct - winner.meanPct);
    } else if (s.model.empty()) {
      c.remark = "chosen";
      s.model = c.model;
      s.why = static_cast<int>(m) == best
                  ? c.model + " has the smallest leave-one-view-out error (" + percent(c.meanPct) +
                        "), and no simpler model is within " + slackText + " of it."
                  : "The simplest model within " + slackText + " of the best: " + c.model + " has " + percent(c.meanPct) +
                        " leaving one view out, the best is " + winner.model + " with " + percent(winner.meanPct) + ".";
    } else {
      c.remark = static_cast<int>(m) == best ? "best, but a simpler one is as good" : "a simpler one is as good";
    }
  }
  if (goodEnoughPct) s.why += " No model reached the stated tolerance of " + percent(*goodEnoughPct) + ".";
  return s;
}

std::string selectionTable(const Selection& s) {
  std::string out = "candidate     views   leave-one-out %   std. error %  us/frame  seconds  remark\n";
  char line[256];
  for (const Candidate& c : s.candidates) {
    const std::string views = std::to_string(c.answered) + "/" + std::to_string(c.views);
    std::snprintf(line, sizeof line, "%-12s %6s %17.4g %14.4g %9.3g %8.2f  ", c.model.c_str(), views.c_str(), c.meanPct,
                  c.standardErrorPct, c.predictUs, c.timeUs * 1e-6);
    out += line + c.remark + "\n";
  }
  if (s.leftOut < s.trainingViews)
    out += std::to_string(s.leftOut) + " of " + std::to_string(s.trainingViews) +
           " training views were left out one at a time, evenly spread.\n";
  return out + s.why + "\n";
}

}  // namespace glint
