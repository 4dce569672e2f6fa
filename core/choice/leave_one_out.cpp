// SPDX-License-Identifier: BSD-3-Clause
#include "core/choice/leave_one_out.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <set>
#include <utility>

#include "core/base/evenly.h"
#include "core/base/number_text.h"
#include "core/base/progress.h"
#include "core/base/stage_times.h"
#include "core/light/left_out.h"
#include "core/pipeline/carried.h"
#include "core/pipeline/lobe_stage.h"
#include "core/pipeline/metrics.h"
#include "core/pipeline/training.h"
#include "core/surface/mesh_policy.h"

namespace glint {

namespace {
Answer failed(Failure failure) {
  Answer a;
  a.failure = std::move(failure);
  a.predictUs = a.variation = std::nan("");
  return a;
}

/// Even without any error on the views that are left it would not be as good as the best.
bool cannotWin(const std::vector<Answer>& answers, int tried, const RankingSoFar& known) {
  double sum = 0;
  int count = 0;
  for (int i = 0; i < static_cast<int>(answers.size()); ++i) {
    if (i < tried && answers[i].errorPct && !known.possible[i]) return false;  // here it knows more than the best
    if (!known.possible[i]) continue;
    ++count;
    if (i < tried) sum += answers[i].countedPct();
  }
  return count > 0 && sum / count > known.best;
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
  const ContourMetrics m = comparedHighlights(left.highlight, h, left.camera, left.highlight.touchesBorder);
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
  Outcome<std::shared_ptr<const Surface>> found =
      correctedSurface(*inspection->scene, *inspection->surfaces, frame, model.needsLight() && light ? light->correction : none,
                       meshPolicy(inspection->request.settings));
  if (found) found = carried(*std::move(found), inspection->lightFromScene(frame, left.highlight.light));
  return found;
}

bool isSmoothedAlone(const SurfaceCorrection& correction) {
  return correction.smoothed && !correction.depth && !correction.normals;
}

bool fitsPixels(const Settings& settings) {
  const std::string& evidence = settings.text("fit.evidence");
  return evidence == "auto" || evidence == "pixels";
}

namespace {
/// From the fit to the pixels of all views. It needs no light, whose estimate takes longest where highlights are far from a limit
/// angle's. Nothing where a light may correct the surface, or another way may answer better.
std::optional<ModelFit> fitNearAll(const Fold& fold, const HighlightModel& model, const Settings& settings,
                                   const ProgressFn& progress) {
  const SurfaceCorrection* const chosen =
      fold.inspection->chosenFor(fold.inspection->keyFor(fold.left.frame, fold.left.highlight.light));
  if (!model.takesPixels() || fold.light || !fold.pixels.near || !fitsPixels(settings) || !chosen || *chosen ||
      settings.flag("light.refine_depth") || settings.flag("light.refine_normals"))
    return std::nullopt;
  const Outcome<ModelFit> fit = fitModel(model, fold.others, std::nullopt, settings, fold.pixels, progress);
  return fit && fit->solver == "pixels" && fit->poor.empty() ? std::optional(*fit) : std::nullopt;
}

Outcome<ModelFit> newFit(Fold& fold, const HighlightModel& model, const Settings& settings, const ProgressFn& progress) {
  if (!model.needsLight()) return fitModel(model, fold.others, std::nullopt, settings, fold.pixels, progress);
  if (std::optional<ModelFit> near = fitNearAll(fold, model, settings, progress)) return *std::move(near);
  if (!fold.light) {
    fold.light = fitLight(fold.others, *fold.inspection->scene, *fold.inspection->surfaces, settings,
                          fold.inspection->chosenFor(fold.inspection->keyFor(fold.left.frame, fold.left.highlight.light)));
    if (fold.light->correction) {
      const Outcome<std::shared_ptr<const Surface>> surface = fold.surfaceOf(fold.left.frame, model);
      fold.leftSurface = surface ? *surface : nullptr;
    }
  }
  if (model.needsCanonicalContours() && fold.light->light && !std::exchange(fold.canonicalTried, true))
    for (TrainingView& v : fold.light->views) addCanonicalContour(v, fold.light->light->light, settings);
  const SurfaceCorrection& correction = fold.light->correction;
  return fitModel(model, fold.light->views, fold.light->light, settings,
                  isSmoothedAlone(correction) ? fold.onSmoothed
                  : correction                ? KnownPixels{}
                                              : fold.pixels,
                  progress);
}
}  // namespace

Outcome<ModelFit> fitFold(Fold& fold, const HighlightModel& model, const Settings& settings, PoorFits poor,
                          const ProgressFn& progress) {
  auto made = fold.fits.find(model.id());
  if (made == fold.fits.end()) made = fold.fits.emplace(model.id(), newFit(fold, model, settings, progress)).first;
  return accepted(made->second, poor);
}

PoorFits poorFitsFor(const ModelResult& result) {
  const bool any = std::any_of(result.fits.begin(), result.fits.end(),
                               [](const ModelResult::Fit& f) { return f.fit && !f.fit->poor.empty(); });
  return any ? PoorFits::Take : PoorFits::Refuse;
}

Answer leaveOut(Fold& fold, const HighlightModel& model, const Settings& settings, PoorFits poor, const ProgressFn& progress) {
  const Outcome<ModelFit> fit = fitFold(fold, model, settings, poor, progress);
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
  std::vector<Fold> all;
  for (const std::size_t left : evenly(usable, kMostLeftOut)) {
    Fold fold;
    fold.inspection = &inspection;
    fold.left = inspection.viewAsGiven(static_cast<int>(left));
    fold.leftSurface = fold.left.surface;
    const FitKey key = inspection.keyFor(fold.left.frame, fold.left.highlight.light);
    // The whole frame is left out: another highlight in it has seen the same camera and the same errors.
    std::set<int> out{fold.left.frame};
    for (std::size_t i = 0; i < inspection.views.size(); ++i)
      if (together == LeaveOut::Place && places[i] == places[left] && inspection.views[i].highlight.light == key.light)
        out.insert(inspection.views[i].frame);
    for (TrainingView& v : inspection.viewsOf(key, true))
      if (v.seen && !out.count(v.frame)) fold.others.push_back(std::move(v));
    fold.pixels = knownPixelsOf(inspection, key);
    fold.pixels.near = std::exchange(fold.pixels.fit, nullptr);  // that of all views
    all.push_back(std::move(fold));
  }
  return all;
}

double rankedPct(const std::vector<Answer>& answers, const std::vector<char>& possible) {
  double sum = 0;
  int count = 0;
  for (std::size_t i = 0; i < answers.size(); ++i)
    if (possible[i]) sum += answers[i].countedPct(), ++count;
  return count ? sum / count : std::nan("");
}

Candidate tryModel(const Inspection& inspection, const HighlightModel& model, std::vector<Fold>& folds,
                   std::vector<Answer>& answers, const RankingSoFar& known, PoorFits poor, const ProgressFn& progress) {
  Candidate c;
  c.model = model.id();
  c.views = static_cast<int>(folds.size());
  answers.assign(folds.size(), {});
  const Clock::time_point start = Clock::now();
  // In groups of fixed size, so that what is given up does not depend on the number of threads.
  constexpr int kGroup = 2;
  const std::string stage = "leave one out " + c.model;
  int tried = 0, shown = 0;
  std::mutex asking;  // fits that run side by side ask as well
  while (tried < c.views && !cannotWin(answers, tried, known)) {
    const int count = std::min(kGroup, c.views - tried);
    const ProgressFn goOn = [&](const StageEvent& e) {
      const std::scoped_lock lock(asking);
      if (e.stage == stage) shown = tried + e.done;
      return report(progress, {stage, shown, c.views});
    };
    parallelFor(
        count, [&](int i) { answers[tried + i] = leaveOut(folds[tried + i], model, inspection.request.settings, poor, goOn); },
        goOn, stage);
    tried += count;
  }
  c.timeUs = microsecondsSince(start);
  std::vector<double> errors, times;
  for (int i = 0; i < tried; ++i) {
    if (answers[i].errorPct) {
      errors.push_back(*answers[i].errorPct);
      times.push_back(answers[i].predictUs);
    } else if (c.remark.empty()) {
      c.remark = "without frame " + inspection.scene->frames[folds[i].left.frame].id + ": " + answers[i].failure->message();
    }
  }
  c.tried = tried;
  c.answered = static_cast<int>(errors.size());
  double sum = 0, squares = 0;
  for (const double e : errors) sum += e;
  c.meanPct = errors.empty() ? std::nan("") : sum / double(errors.size());
  for (const double e : errors) squares += (e - c.meanPct) * (e - c.meanPct);
  c.standardErrorPct = errors.size() > 1 ? std::sqrt(squares / double(errors.size() - 1) / double(errors.size())) : std::nan("");
  c.predictUs = statisticOf(times).median;
  return c;
}

ExcessError excessOf(const std::vector<Answer>& a, const std::vector<Answer>& b, const std::vector<char>& possible) {
  std::vector<double> d;
  for (std::size_t i = 0; i < a.size(); ++i)
    if (possible[i]) d.push_back(a[i].countedPct() - b[i].countedPct());
  ExcessError e;
  const double n = static_cast<double>(d.size());
  for (const double x : d) e.mean += x / n;
  double squares = 0;
  for (const double x : d) squares += (x - e.mean) * (x - e.mean);
  if (n > 1) e.standardError = std::sqrt(squares / (n - 1) / n);
  return e;
}

}  // namespace glint
