// SPDX-License-Identifier: BSD-3-Clause
#include "core/advise/influence.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "core/advise/polar_residual.h"
#include "core/base/evenly.h"
#include "core/base/progress.h"
#include "core/choice/leave_one_out.h"
#include "core/pipeline/comparison.h"

namespace glint {
namespace {

/// Mean contour error of one comparison as influence counts it: over its observed highlights, those missed at kNoPredictionPct.
/// Empty if the light shows none there.
std::optional<double> countedPct(const FrameComparison& c) {
  double sum = 0;
  int n = 0;
  for (const FrameComparison::Row& row : c.rows) {
    if (row.observed < 0) continue;
    const bool counts = row.metrics && std::isfinite(row.metrics->contourErrorPct);
    sum += counts ? std::min(row.metrics->contourErrorPct, kNoPredictionPct) : kNoPredictionPct;
    ++n;
  }
  if (n == 0) return std::nullopt;
  return sum / n;
}

bool shows(const Inspection& inspection, int frame, const std::string& light) {
  const std::vector<Highlight>& seen = inspection.evidence[std::size_t(frame)].scored();
  return std::any_of(seen.begin(), seen.end(), [&](const Highlight& h) { return h.light == light; });
}

std::vector<int> probesOf(const Inspection& inspection, int most) {
  std::vector<int> all;
  for (const FrameEvidence& e : inspection.evidence)
    if (e.frame >= 0 && inspection.isHeldOut(e.frame) && !inspection.isTraining(e.frame) && !e.scored().empty())
      all.push_back(e.frame);
  return evenly(all, std::size_t(most));
}

const ModelFit* fitOf(const Inspection& inspection, const ModelResult& result, const TrainingView& view) {
  for (const ModelResult::Fit& f : result.fits)
    if (f.fit && f.light == view.highlight.light &&
        (!f.surface || (inspection.surfaces && *f.surface == inspection.surfaces->keyOf(view.frame))))
      return &*f.fit;
  return nullptr;
}

std::optional<Eigen::Vector3d> placeOf(const ModelFit& fit) {
  if (fit.lightEstimate) {
    if (fit.lightEstimate->atInfinity()) return std::nullopt;
    return fit.lightEstimate->position();
  }
  if (fit.ellipsoid()) return fit.ellipsoid()->centre();
  return std::nullopt;
}

void compareFits(const ModelFit& with, const ModelFit& without, ModelInfluence& influence) {
  const std::optional<Eigen::Vector3d> a = placeOf(with), b = placeOf(without);
  if (a && b) influence.lightShift = std::max(influence.lightShift.value_or(0), (*a - *b).norm());
  if (!with.ellipsoid() || !without.ellipsoid()) return;
  double change = influence.axesChange.value_or(0);
  for (int i = 0; i < 3; ++i) {
    const double before = with.ellipsoid()->semiAxes()(i), after = without.ellipsoid()->semiAxes()(i);
    if (before > 0) change = std::max(change, std::abs(after - before) / before);
  }
  influence.axesChange = change;
}

/// A mean of what is there; several folds of one frame add to it, as two highlights in it are two folds.
struct Mean {
  double sum = 0;
  int n = 0;
  void add(std::optional<double> v) {
    if (v) sum += *v, ++n;
  }
  std::optional<double> value() const { return n ? std::optional(sum / n) : std::nullopt; }
};

/// Training frames with a highlight that is used.
int seenFrames(const Inspection& inspection) {
  std::set<int> frames;
  for (const TrainingView& v : inspection.views)
    if (v.seen) frames.insert(v.frame);
  return int(frames.size());
}

/// One model's fit to the others of each fold, and the errors of these fits on the probes, fold by fold.
struct Refits {
  std::vector<Answer> answers;
  std::vector<std::optional<double>> errors;
};

/// Error of a fold's fit on one probe. Empty without a fit, and where the light shows nothing.
std::optional<double> errorOn(int probe, const Fold& fold, const HighlightModel& model, const Answer& answer) {
  const Inspection& inspection = *fold.inspection;
  const std::string& light = fold.left.highlight.light;
  if (!answer.fit || !shows(inspection, probe, light)) return std::nullopt;
  const Camera camera = inspection.cameraFor(probe, light);
  const Outcome<std::shared_ptr<const Surface>> surface = fold.surfaceOf(probe, model);
  Prediction p = model.predict(*answer.fit, camera, surface ? surface->get() : nullptr, inspection.request.settings);
  return countedPct(compareFrame(inspection.evidence[std::size_t(probe)], light, camera, std::move(p)));
}

/// @param progress  of folds * (1 + probes) steps
Refits refit(const HighlightModel& model, PoorFits poor, std::vector<Fold>& folds, const std::vector<int>& probes,
             const ProgressFn& progress, const std::string& stage) {
  const int n = int(folds.size()), m = int(probes.size());
  Refits result{std::vector<Answer>(folds.size()), std::vector<std::optional<double>>(folds.size() * probes.size())};
  parallelFor(
      n,
      [&](int i) {
        Fold& fold = folds[std::size_t(i)];
        result.answers[std::size_t(i)] = leaveOut(fold, model, fold.inspection->request.settings, poor);
      },
      progress, stage);
  // One piece of work for each probe with each fit, so that a stop is heeded soon.
  const ProgressFn later = [&](const StageEvent& e) { return progress({e.stage, n + e.done, e.total}); };
  parallelFor(
      n * m,
      [&](int i) {
        const std::size_t fold = std::size_t(i / m);
        result.errors[std::size_t(i)] = errorOn(probes[std::size_t(i % m)], folds[fold], model, result.answers[fold]);
      },
      later, stage);
  return result;
}

/// What leaving out one frame does to one model: means over the folds of that frame.
ModelInfluence influenceOfFrame(int frame, const ModelResult& result, const std::vector<Fold>& folds, const Refits& refits,
                                const std::vector<int>& probes) {
  ModelInfluence influence;
  Mean left, held, before;
  for (std::size_t f = 0; f < folds.size(); ++f) {
    const TrainingView& view = folds[f].left;
    if (view.frame != frame) continue;
    const Answer& answer = refits.answers[f];
    left.add(answer.errorPct);
    if (!answer.fit) {
      if (!influence.failure) influence.failure = answer.failure;
      continue;
    }
    if (const ModelFit* with = fitOf(*folds[f].inspection, result, view)) compareFits(*with, *answer.fit, influence);
    for (std::size_t p = 0; p < probes.size(); ++p) {
      const std::optional<double>& error = refits.errors[f * probes.size() + p];
      held.add(error);
      for (const FrameComparison& c : result.frames)
        if (error && c.frame == probes[p] && c.light == view.highlight.light) before.add(countedPct(c));
    }
  }
  influence.leftOutPct = left.value();
  influence.heldOutPct = held.value();
  if (held.value() && before.value()) influence.changePct = *held.value() - *before.value();
  return influence;
}

}  // namespace
std::optional<double> influenceOf(const Influence& influence, int frame, const std::string& model) {
  for (const FrameInfluence& f : influence.frames) {
    if (f.frame != frame) continue;
    const auto it = f.models.find(model);
    if (it == f.models.end()) return std::nullopt;
    return influence.probes.empty() ? it->second.leftOutPct : it->second.changePct;
  }
  return std::nullopt;
}

Influence measureInfluence(const Inspection& inspection, const ProgressFn& progress, int mostProbes) {
  require(inspection.scene && inspection.surfaces && mostProbes >= 0, "measureInfluence: the inspection is empty");
  std::vector<Fold> folds = foldsOf(inspection, LeaveOut::Frame);
  Influence influence;
  influence.trainingFrames = seenFrames(inspection);
  influence.probes = probesOf(inspection, mostProbes);
  std::set<int> leftFrames;
  for (const Fold& fold : folds) leftFrames.insert(fold.left.frame);
  for (const int frame : leftFrames) influence.frames.push_back({frame, {}});

  const int steps = int(folds.size()) * (1 + int(influence.probes.size()));
  int done = 0;
  for (const auto& [id, result] : inspection.models) {
    const std::string stage = "influence on " + id;
    const ProgressFn part = [&](const StageEvent& e) {
      return report(progress, {stage, done + e.done, int(inspection.models.size()) * steps});
    };
    const Refits refits = refit(modelByName(id), poorFitsFor(result), folds, influence.probes, part, stage);
    Mean baseline;
    for (const FrameComparison& c : result.frames)
      if (std::count(influence.probes.begin(), influence.probes.end(), c.frame)) baseline.add(countedPct(c));
    if (baseline.value()) influence.baselinePct[id] = *baseline.value();
    for (FrameInfluence& frame : influence.frames)
      frame.models[id] = influenceOfFrame(frame.frame, result, folds, refits, influence.probes);
    done += steps;
  }
  return influence;
}

}  // namespace glint
