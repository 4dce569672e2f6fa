// SPDX-License-Identifier: BSD-3-Clause
#include "core/diagnose/left_out_error.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/base/parallel.h"
#include "core/fit/training.h"
#include "core/model/plausible.h"
#include "core/selection/leave_one_out.h"
#include "core/surface/mesh_policy.h"

namespace glint {
namespace {

constexpr double kWorthwhile = 0.9;  // of the error before: a change that gains less is not worth a click

const LeftOutError::View* same(const LeftOutError::View& view, const LeftOutError& in) {
  const auto it = std::find_if(in.views.begin(), in.views.end(),
                               [&](const LeftOutError::View& v) { return v.frame == view.frame && v.light == view.light; });
  return it == in.views.end() ? nullptr : &*it;
}

}  // namespace

bool isAstray(const LeftOutError::View& view) { return !view.answered || view.pct > kLargestExpectedPct; }

int LeftOutError::answered() const {
  return static_cast<int>(std::count_if(views.begin(), views.end(), [](const View& v) { return v.answered; }));
}

double LeftOutError::meanPct() const {
  if (views.empty()) return std::nan("");
  double sum = 0;
  for (const View& v : views) sum += v.pct;
  return sum / double(views.size());
}

LeftOutError leftOutError(const Inspection& inspection, const HighlightModel& model, const ProgressFn& progress) {
  std::vector<Fold> folds = foldsOf(inspection, LeaveOut::Place);
  std::vector<Answer> answers;
  RankingSoFar known;
  known.possible.assign(folds.size(), 1);
  const Candidate tried = tryModel(inspection, model, folds, answers, known, PoorFits::Take, progress);
  LeftOutError error;
  error.firstFailure = tried.remark;
  for (std::size_t i = 0; i < folds.size(); ++i)
    error.views.push_back({folds[i].left.frame, folds[i].left.highlight.light, true, answers[i].countedPct(),
                           radiusPx(folds[i].left.highlight.contour), answers[i].errorPct.has_value()});
  return error;
}

std::vector<int> spreadFrames(const Inspection& inspection, int most) {
  std::vector<int> usable, spread;
  for (int f = 0; f < static_cast<int>(inspection.evidence.size()); ++f)
    if (!inspection.evidence[std::size_t(f)].highlights.empty() && (inspection.isTraining(f) || inspection.isHeldOut(f)))
      usable.push_back(f);
  const int n = static_cast<int>(usable.size()), count = std::min(n, most);
  for (int i = 0; i < count; ++i) spread.push_back(usable[std::size_t(i) * std::size_t(n) / std::size_t(count)]);
  return spread;
}

LeftOutError unseenError(const Inspection& inspection, const Inspection& evidence, const std::vector<int>& frames,
                         const HighlightModel& model, const ProgressFn& progress) {
  LeftOutError error = leftOutError(inspection, model, progress);
  std::vector<Fold> folds;  // one for each highlight; all views train
  for (const int frame : frames) {
    if (inspection.train.perSurface || std::ranges::count(inspection.train.frames, frame)) continue;
    if (std::ranges::count(inspection.request.excluded, frame)) continue;
    const FrameEvidence& seen = evidence.evidence[std::size_t(frame)];
    const Outcome<std::shared_ptr<const Surface>> surface =
        inspection.surfaces->surfaceOf(frame, meshPolicy(inspection.request.settings));
    for (std::size_t h = 0; h < seen.highlights.size(); ++h) {
      Fold fold;
      fold.inspection = &inspection;
      fold.left = trainingView(seen, int(h), inspection.scene->frames[std::size_t(frame)].camera, surface ? *surface : nullptr);
      fold.leftSurface = fold.left.surface;
      folds.push_back(std::move(fold));
    }
  }
  std::map<FitKey, std::pair<Fold, Outcome<ModelFit>>> fitted;
  for (const Fold& fold : folds) {
    const FitKey key = inspection.keyFor(fold.left.frame, fold.left.highlight.light);
    if (fitted.count(key)) continue;
    Fold all = fold;
    for (std::size_t i = 0; i < inspection.views.size(); ++i)
      if (inspection.views[i].seen && inspection.keyFor(inspection.views[i].frame, inspection.views[i].highlight.light) == key)
        all.others.push_back(inspection.viewAsGiven(int(i)));
    Outcome<ModelFit> fit = fitFold(all, model, inspection.request.settings, PoorFits::Take);
    fitted.emplace(key, std::pair(std::move(all), std::move(fit)));
  }
  const std::size_t before = error.views.size();
  error.views.resize(before + folds.size());
  std::vector<std::string> failures(folds.size());
  const ProgressFn part = [&](const StageEvent& e) { return report(progress, e); };
  parallelFor(
      int(folds.size()),
      [&](int i) {
        const auto& [all, fit] =
            fitted.at(inspection.keyFor(folds[std::size_t(i)].left.frame, folds[std::size_t(i)].left.highlight.light));
        Fold fold = folds[std::size_t(i)];
        fold.light = all.light;
        if (all.light && all.light->correction) {
          const Outcome<std::shared_ptr<const Surface>> corrected = fold.surfaceOf(fold.left.frame, model);
          fold.leftSurface = corrected ? *corrected : nullptr;
        }
        LeftOutError::View& view = error.views[before + std::size_t(i)];
        view = {
            fold.left.frame, fold.left.highlight.light, false, kNoPredictionPct, radiusPx(fold.left.highlight.contour), false};
        if (!fit) return;
        const Answer answer = predictLeft(fold, model, *fit, inspection.request.settings);
        view.pct = answer.countedPct();
        view.answered = answer.errorPct.has_value();
        if (answer.failure) failures[std::size_t(i)] = answer.failure->message();
      },
      part, "held-out frames, " + model.id());
  for (std::size_t i = 0; i < failures.size() && error.firstFailure.empty(); ++i)
    if (!failures[i].empty())
      error.firstFailure = "held-out frame " + inspection.scene->frames[std::size_t(folds[i].left.frame)].id + ": " + failures[i];
  return error;
}

LeftOutError ofTraining(const LeftOutError& error, bool training) {
  LeftOutError some = error;
  std::erase_if(some.views, [&](const LeftOutError::View& v) { return v.training != training; });
  return some;
}

LeftOutError commonViews(const LeftOutError& of, const LeftOutError& with) {
  LeftOutError common;
  common.firstFailure = of.firstFailure;
  for (const LeftOutError::View& v : of.views)
    if (same(v, with)) common.views.push_back(v);
  return common.views.empty() ? of : common;
}

bool isBetter(const LeftOutError& after, const LeftOutError& before) {
  if (after.views.empty() || after.answered() == 0) return false;
  const LeftOutError a = commonViews(after, before), b = commonViews(before, after);
  const double gain = b.meanPct() - a.meanPct();
  if (!(gain > kNegligiblePct && a.meanPct() < kWorthwhile * b.meanPct())) return false;
  std::vector<double> gains;
  for (const LeftOutError::View& v : a.views)
    if (const LeftOutError::View* const earlier = same(v, b)) gains.push_back(earlier->pct - v.pct);
  if (gains.size() < 2) return true;
  double squares = 0;
  for (const double g : gains) squares += (g - gain) * (g - gain);
  if (gain > std::sqrt(squares / double(gains.size() - 1) / double(gains.size()))) return true;
  // One view that went astray makes that error as large as the gain: then it counts that fewer go astray, and no other one.
  bool fewer = false;
  for (const LeftOutError::View& v : a.views) {
    const LeftOutError::View* const earlier = same(v, b);
    if (!earlier) continue;
    if (isAstray(v) && !isAstray(*earlier)) return false;
    fewer = fewer || (!isAstray(v) && isAstray(*earlier));
  }
  return fewer;
}

}  // namespace glint
