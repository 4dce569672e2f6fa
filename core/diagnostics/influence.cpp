// SPDX-License-Identifier: BSD-3-Clause
#include "core/diagnostics/influence.h"

#include <algorithm>
#include <cmath>

#include "core/base/parallel.h"
#include "core/diagnostics/polar_residual.h"
#include "core/score/comparison.h"
#include "core/selection/leave_one_out.h"

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
  const int n = int(all.size()), kept = std::min(n, most);
  std::vector<int> probes;
  for (int i = 0; i < kept; ++i) probes.push_back(all[std::size_t(i) * std::size_t(n) / std::size_t(kept)]);
  return probes;
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

/// A mean that several folds of one frame add to: two highlights in it are two folds.
struct Mean {
  double sum = 0;
  int n = 0;
  void add(double v) { sum += v, ++n; }
  std::optional<double> value() const { return n ? std::optional(sum / n) : std::nullopt; }
};

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
  Influence influence;
  std::vector<Fold> folds = foldsOf(inspection, LeaveOut::Frame);
  const int n = int(folds.size());
  for (int f = 0; f < int(inspection.scene->frames.size()); ++f)
    if (std::any_of(inspection.views.begin(), inspection.views.end(),
                    [&](const TrainingView& v) { return v.frame == f && v.seen; }))
      ++influence.trainingFrames;
  influence.probes = probesOf(inspection, mostProbes);
  for (const Fold& fold : folds)
    if (influence.frames.empty() || influence.frames.back().frame != fold.left.frame)
      influence.frames.push_back({fold.left.frame, {}});
  std::sort(influence.frames.begin(), influence.frames.end(), [](const auto& a, const auto& b) { return a.frame < b.frame; });
  influence.frames.erase(std::unique(influence.frames.begin(), influence.frames.end(),
                                     [](const auto& a, const auto& b) { return a.frame == b.frame; }),
                         influence.frames.end());
  const int probes = int(influence.probes.size());
  const Settings& settings = inspection.request.settings;
  int round = 0;
  const int rounds = int(inspection.models.size());
  for (const auto& [id, result] : inspection.models) {
    const HighlightModel& model = modelByName(id);
    const std::string stage = "influence on " + id;
    const ProgressFn part = [&](const StageEvent& e) {
      return report(progress, {stage, round * n * (1 + probes) + e.done, rounds * n * (1 + probes)});
    };
    std::vector<Answer> answers(folds.size());
    const PoorFits poor = poorFitsFor(result);
    parallelFor(
        n, [&](int i) { answers[std::size_t(i)] = leaveOut(folds[std::size_t(i)], model, settings, poor); }, part, stage);

    // Every probe with every fold's fit; one piece of work each, so that a stop is heeded soon.
    std::vector<std::optional<double>> errors(std::size_t(n) * std::size_t(probes));
    const ProgressFn later = [&](const StageEvent& e) { return part({e.stage, n + e.done, e.total}); };
    parallelFor(
        n * probes,
        [&](int i) {
          const int fold = i / probes, frame = influence.probes[std::size_t(i % probes)];
          const std::string& light = folds[std::size_t(fold)].left.highlight.light;
          const Answer& answer = answers[std::size_t(fold)];
          if (!answer.fit || !shows(inspection, frame, light)) return;
          const Camera& camera = inspection.scene->frames[std::size_t(frame)].camera;
          const Outcome<std::shared_ptr<const Surface>> surface = folds[std::size_t(fold)].surfaceOf(frame, model);
          Prediction p = model.predict(*answer.fit, camera, surface ? surface->get() : nullptr, settings);
          errors[std::size_t(i)] = countedPct(compareFrame(inspection.evidence[std::size_t(frame)], light, camera, std::move(p)));
        },
        later, stage);

    Mean baseline;
    for (const FrameComparison& c : result.frames)
      if (std::find(influence.probes.begin(), influence.probes.end(), c.frame) != influence.probes.end())
        if (const std::optional<double> pct = countedPct(c)) baseline.add(*pct);
    if (baseline.value()) influence.baselinePct[id] = *baseline.value();

    for (FrameInfluence& frame : influence.frames) {
      ModelInfluence& m = frame.models[id];
      Mean left, held, before;
      for (int f = 0; f < n; ++f) {
        if (folds[std::size_t(f)].left.frame != frame.frame) continue;
        const Answer& answer = answers[std::size_t(f)];
        if (answer.errorPct) left.add(*answer.errorPct);
        if (!answer.fit) {
          if (!m.failure) m.failure = answer.failure;
          continue;
        }
        if (const ModelFit* with = fitOf(inspection, result, folds[std::size_t(f)].left)) compareFits(*with, *answer.fit, m);
        for (int p = 0; p < probes; ++p) {
          const std::optional<double>& error = errors[std::size_t(f) * std::size_t(probes) + std::size_t(p)];
          if (!error) continue;
          held.add(*error);
          for (const FrameComparison& c : result.frames)
            if (c.frame == influence.probes[std::size_t(p)] && c.light == folds[std::size_t(f)].left.highlight.light)
              if (const std::optional<double> pct = countedPct(c)) before.add(*pct);
        }
      }
      m.leftOutPct = left.value();
      m.heldOutPct = held.value();
      if (held.value() && before.value()) m.changePct = *held.value() - *before.value();
    }
    ++round;
  }
  return influence;
}

}  // namespace glint
