// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "core/base/evenly.h"
#include "core/base/number_text.h"
#include "core/base/stage_times.h"
#include "core/choice/leave_one_out.h"
#include "core/model/star.h"
#include "core/pipeline/metrics.h"
#include "core/pipeline/training.h"

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
  std::vector<Other> all;
  for (int f = 0; f < static_cast<int>(inspection.scene->frames.size()); ++f) {
    if (!inspection.isHeldOut(f) || inspection.isTraining(f)) continue;
    std::set<std::string> lights;
    for (std::size_t i = 0; i < folds.size(); ++i) {
      const std::string& light = folds[i].left.highlight.light;
      if (!answers[i].fit || !isOn(*inspection.scene, inspection.request.whatIf, f, light)) continue;
      if (lights.insert(light).second) all.push_back({f, light, &*answers[i].fit});
    }
  }
  return evenly(all, kOthersLookedAt);
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

/// Holds walks on local quadrics against exact ones; each check decides, or leaves it to the next.
class PatchTrial {
 public:
  PatchTrial(const Inspection& inspection, const HighlightModel& model, const std::vector<Fold>& folds,
             const std::vector<Answer>& exact, const ProgressFn& progress)
      : inspection_(inspection), model_(model), folds_(folds), exact_(exact), progress_(progress) {
    onPatches_.set("predict.query", std::string("local-quadric"));
    c_.variation = c_.meanPct = c_.predictUs = c_.exactUs = std::nan("");
  }

  std::optional<PatchChoice> run(double mostPct) {
    if (std::optional<PatchChoice> decision = onLeftOutViews()) return decision;
    if (c_.views == 0) return std::nullopt;
    if (std::optional<PatchChoice> decision = onOthers()) return decision;
    c_.meanPct = sumPct_ / c_.views;
    if (c_.meanPct > mostPct)
      return decided(false, "on local quadrics the leave-one-out error is " + percentText(c_.meanPct) + ", above the " +
                                percentText(mostPct) + " that the rule allows");
    // For the report alone, so that a choice is the same on every machine.
    c_.predictUs = medianTime(onPatches_);
    c_.exactUs = medianTime(settings_);
    const std::string times =
        formatted("%.3g us", c_.predictUs) + " instead of " + formatted("%.3g us", c_.exactUs) + " per prediction";
    return decided(true, "over a highlight the curvature varies by at most " + formatted("%.2g", c_.variation) + " (limit " +
                             formatted("%g", kLargestVariation) + "), the leave-one-out error is " + percentText(c_.meanPct) +
                             " (the rule allows " + percentText(mostPct) + "), and they take " + times);
  }

 private:
  /// Leaves `views` at 0 where nothing is walked.
  std::optional<PatchChoice> onLeftOutViews() {
    for (std::size_t i = 0; i < folds_.size(); ++i) {
      if (!exact_[i].errorPct) continue;
      checkStop(static_cast<int>(i), static_cast<int>(folds_.size()));
      const std::string& id = inspection_.scene->frames[folds_[i].left.frame].id;
      const Answer a = predictLeft(folds_[i], model_, *exact_[i].fit, onPatches_);
      if (std::isnan(a.variation) && a.highlights > 0) {  // this fit is not walked, as with a long light
        c_.views = 0;
        return std::nullopt;
      }
      ++c_.views;
      if (tooCurved(a.variation)) return curved(id);
      if (!a.errorPct) return decided(false, "on local quadrics frame " + id + " has no prediction: " + a.failure->message());
      if (a.highlights != exact_[i].highlights || a.coverage < exact_[i].coverage)
        return decided(false, "in frame " + id + " local quadrics do not give the same highlights");
      sumPct_ += *a.errorPct;
      if (timed_.size() < kTimedViews) timed_.push_back(i);
    }
    return std::nullopt;
  }

  /// On frames to predict, against what exact walks predict there.
  std::optional<PatchChoice> onOthers() {
    for (const Other& o : othersOf(inspection_, folds_, exact_)) {
      checkStop(c_.views, c_.views);
      const Frame& frame = inspection_.scene->frames[o.frame];
      const Outcome<std::shared_ptr<const Surface>> surface = surfaceFor(inspection_, o.frame, o.light);
      if (!surface) continue;  // no prediction of any kind
      const Camera camera = inspection_.cameraFor(o.frame, o.light);
      const Prediction walked = model_.predict(*o.fit, camera, surface->get(), onPatches_);
      ++c_.others;
      if (tooCurved(variationOf(walked))) return curved(frame.id);
      const Prediction whole = model_.predict(*o.fit, camera, surface->get(), settings_);
      if (!sameHighlights(whole, walked))
        return decided(false, "in frame " + frame.id + ", a frame to predict, local quadrics do not give the same highlights");
    }
    return std::nullopt;
  }

  /// The time of one prediction, us. Folds run side by side; these times are of one thread.
  double medianTime(const Settings& how) const {
    std::vector<double> times;
    for (const std::size_t i : timed_) {
      double shortest = std::numeric_limits<double>::infinity();
      for (int r = 0; r < kTimedRepeats; ++r) {
        const Clock::time_point now = Clock::now();
        model_.predict(*exact_[i].fit, folds_[i].left.camera, folds_[i].leftSurface.get(), how);
        shortest = std::min(shortest, microsecondsSince(now));
      }
      times.push_back(shortest);
    }
    return statisticOf(times).median;
  }

  PatchChoice decided(bool goodEnough, const std::string& why) {
    c_.goodEnough = goodEnough;
    c_.timeUs = microsecondsSince(start_);
    c_.why = (goodEnough ? "Walks on local quadrics are good enough: " : "Walks stay exact: ") + why + " (found in " +
             formatted("%.3g ms).", c_.timeUs * 1e-3);
    return c_;
  }
  bool tooCurved(double variation) {
    c_.variation = std::fmax(c_.variation, variation);
    return c_.variation > kLargestVariation;
  }
  PatchChoice curved(const std::string& id) {
    return decided(false, "over the highlight of frame " + id + " the curvature varies by " + formatted("%.2g", c_.variation) +
                              ", and local quadrics are good enough up to " + formatted("%g", kLargestVariation));
  }
  void checkStop(int done, int total) const {
    if (!report(progress_, {"local quadrics", done, total})) throw Stopped{};
  }

  const Inspection& inspection_;
  const HighlightModel& model_;
  const std::vector<Fold>& folds_;
  const std::vector<Answer>& exact_;
  const ProgressFn& progress_;
  const Settings& settings_ = inspection_.request.settings;
  Settings onPatches_ = settings_;
  Clock::time_point start_ = Clock::now();
  std::vector<std::size_t> timed_;  ///< folds
  double sumPct_ = 0;               ///< on local quadrics, of the views
  PatchChoice c_;
};

}  // namespace

std::optional<PatchChoice> choosePatches(const Inspection& inspection, const HighlightModel& model,
                                         const std::vector<Fold>& folds, const std::vector<Answer>& exact, double mostPct,
                                         const ProgressFn& progress) {
  if (!model.walks() || inspection.request.settings.text("predict.query") != "exact") return std::nullopt;
  return PatchTrial(inspection, model, folds, exact, progress).run(mostPct);
}

}  // namespace glint
