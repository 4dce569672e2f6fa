// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "core/base/elapsed.h"
#include "core/base/number_text.h"
#include "core/fit/training.h"
#include "core/model/star.h"
#include "core/score/metrics.h"
#include "core/score/statistic.h"
#include "core/selection/leave_one_out.h"

namespace glint {
namespace {

/// Walks on patches and exact ones where they are to agree but for what kLargestVariation allows: about half a percent. More
/// comes from what a patch cannot know, such as the surface's border or a neighbouring highlight.
constexpr double kPatchErrorPct = 0.5;
constexpr int kOthersLookedAt = 12;  ///< frames to predict, evenly spread
constexpr int kTimedViews = 3, kTimedRepeats = 3;

/// Frames to predict with the light that they show and a fit of it, at most kOthersLookedAt, evenly spread.
struct Other {
  int frame;
  std::string light;
  const ModelFit* fit;
};
std::vector<Other> othersOf(const Inspection& inspection, const std::vector<Fold>& folds, const std::vector<Answer>& answers) {
  std::vector<Other> all, some;
  for (int f = 0; f < static_cast<int>(inspection.scene->frames.size()); ++f) {
    if (!inspection.isHeldOut(f) || inspection.isTraining(f)) continue;
    std::set<std::string> lights;
    for (std::size_t i = 0; i < folds.size(); ++i) {
      const std::string& light = folds[i].left.highlight.light;
      if (!answers[i].fit || !isOn(*inspection.scene, inspection.request.whatIf, f, light)) continue;
      if (lights.insert(light).second) all.push_back({f, light, &*answers[i].fit});
    }
  }
  const std::size_t n = all.size(), count = std::min<std::size_t>(n, kOthersLookedAt);
  for (std::size_t i = 0; i < count; ++i) some.push_back(all[i * n / count]);
  return some;
}

bool sameHighlights(const Prediction& exact, const Prediction& walked) {
  std::vector<Polyline> a, b;
  for (const PredictedHighlight& h : exact.highlights()) a.push_back(h.contour);
  for (const PredictedHighlight& h : walked.highlights()) b.push_back(h.contour);
  const auto pairs = matchByOverlap(a, b);
  return a.size() == b.size() && pairs.size() == a.size() && std::all_of(pairs.begin(), pairs.end(), [&](const auto& pair) {
           const PredictedHighlight &e = exact.highlights()[pair.first], &w = walked.highlights()[pair.second];
           const ContourMetrics m =
               compareContours(e.contour, w.contour, w.gaps, w.ellipse, e.brightest.pixel, w.brightest.pixel);
           return w.coverage >= e.coverage && m.contourErrorPct <= kPatchErrorPct;
         });
}

}  // namespace

std::optional<PatchChoice> choosePatches(const Inspection& inspection, const HighlightModel& model,
                                         const std::vector<Fold>& folds, const std::vector<Answer>& exact, double mostPct,
                                         const ProgressFn& progress) {
  const Settings& settings = inspection.request.settings;
  if (!model.walks() || settings.text("predict.query") != "exact") return std::nullopt;
  Settings onPatches = settings;
  onPatches.set("predict.query", std::string("local-quadric"));
  const Clock::time_point start = Clock::now();
  PatchChoice c;
  c.variation = c.meanPct = c.predictUs = c.exactUs = std::nan("");
  const auto decided = [&](bool goodEnough, const std::string& why) {
    c.goodEnough = goodEnough;
    c.timeUs = microsecondsSince(start);
    c.why = (goodEnough ? "Walks on local quadrics are good enough: " : "Walks stay exact: ") + why + " (found in " +
            formatted("%.3g ms).", c.timeUs * 1e-3);
    return c;
  };
  const auto tooCurved = [&] { return c.variation > kLargestVariation; };
  const auto curved = [&](const std::string& id) {
    return decided(false, "over the highlight of frame " + id + " the curvature varies by " + formatted("%.2g", c.variation) +
                              ", and local quadrics are good enough up to " + formatted("%g", kLargestVariation));
  };
  const auto checkStop = [&](int done, int total) {
    if (!report(progress, {"local quadrics", done, total})) throw Stopped{};
  };

  double sum = 0;
  std::vector<std::size_t> timed;
  for (std::size_t i = 0; i < folds.size(); ++i) {
    if (!exact[i].errorPct) continue;
    checkStop(static_cast<int>(i), static_cast<int>(folds.size()));
    const std::string& id = inspection.scene->frames[folds[i].left.frame].id;
    const Answer a = predictLeft(folds[i], model, *exact[i].fit, onPatches);
    if (std::isnan(a.variation) && a.highlights > 0) return std::nullopt;  // this fit is not walked, as with a long light
    ++c.views;
    c.variation = std::fmax(c.variation, a.variation);
    if (tooCurved()) return curved(id);
    if (!a.errorPct) return decided(false, "on local quadrics frame " + id + " has no prediction: " + a.failure->message());
    if (a.highlights != exact[i].highlights || a.coverage < exact[i].coverage)
      return decided(false, "in frame " + id + " local quadrics do not give the same highlights");
    sum += *a.errorPct;
    if (timed.size() < kTimedViews) timed.push_back(i);
  }
  if (c.views == 0) return std::nullopt;

  for (const Other& o : othersOf(inspection, folds, exact)) {
    checkStop(c.views, c.views);
    const Frame& frame = inspection.scene->frames[o.frame];
    const Outcome<std::shared_ptr<const Surface>> surface = surfaceFor(inspection, o.frame, o.light);
    if (!surface) continue;  // no prediction of any kind
    const Prediction walked = model.predict(*o.fit, frame.camera, surface->get(), onPatches);
    ++c.others;
    c.variation = std::fmax(c.variation, variationOf(walked));
    if (tooCurved()) return curved(frame.id);
    const Prediction whole = model.predict(*o.fit, frame.camera, surface->get(), settings);
    if (!sameHighlights(whole, walked))
      return decided(false, "in frame " + frame.id + ", a frame to predict, local quadrics do not give the same highlights");
  }

  c.meanPct = sum / c.views;
  if (c.meanPct > mostPct)
    return decided(false, "on local quadrics the leave-one-out error is " + percentText(c.meanPct) + ", above the " +
                              percentText(mostPct) + " that the rule allows");

  // For the report alone, so that a choice is the same on every machine. Folds run side by side; these times are of one thread.
  const auto timeOf = [&](const Settings& how) {
    std::vector<double> times;
    for (const std::size_t i : timed) {
      double shortest = std::numeric_limits<double>::infinity();
      for (int r = 0; r < kTimedRepeats; ++r) {
        const Clock::time_point now = Clock::now();
        model.predict(*exact[i].fit, folds[i].left.camera, folds[i].leftSurface.get(), how);
        shortest = std::min(shortest, microsecondsSince(now));
      }
      times.push_back(shortest);
    }
    return statisticOf(times).median;
  };
  c.predictUs = timeOf(onPatches);
  c.exactUs = timeOf(settings);
  const std::string times =
      formatted("%.3g us", c.predictUs) + " instead of " + formatted("%.3g us", c.exactUs) + " per prediction";
  return decided(true, "over a highlight the curvature varies by at most " + formatted("%.2g", c.variation) + " (limit " +
                           formatted("%g", kLargestVariation) + "), the leave-one-out error is " + percentText(c.meanPct) +
                           " (the rule allows " + percentText(mostPct) + "), and they take " + times);
}

}  // namespace glint
