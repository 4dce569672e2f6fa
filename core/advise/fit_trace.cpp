// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <map>
#include <utility>

#include "core/advise/diagnosis.h"
#include "core/base/number_text.h"
#include "core/choice/leave_one_out.h"

namespace glint {
namespace {

/// "cost 812 -> 0.31 px^2 in 12 steps". Costs of different rounds cannot be compared: the first and last of the last round.
std::string costText(const SolverRun& run) {
  const auto last = std::find_if(run.rounds.rbegin(), run.rounds.rend(), [](const auto& round) { return !round.empty(); });
  if (last == run.rounds.rend()) return "no step";
  std::string text = formatted("cost %.3g -> %.3g %s", last->front(), last->back(), run.unit.c_str());
  if (run.rounds.size() > 1) text += formatted(" in the last of %zu rounds", run.rounds.size());
  return text + formatted(", %d %s in all", run.steps(), run.steps() == 1 ? "step" : "steps");
}

/// "moved 0.42 m", or where it ended at infinity its turn.
std::string movedText(const SolverRun& run) {
  if (!run.start || !run.end) return "";
  const double a = run.start->w(), b = run.end->w();
  if (a == 0 && b == 0) {
    const Eigen::Vector3d from = run.start->head<3>(), to = run.end->head<3>();
    return formatted(", turned by %.3g deg", std::atan2(from.cross(to).norm(), from.dot(to)) * 180 / M_PI);
  }
  if (a == 0 || b == 0) return b == 0 ? ", ended at infinity" : ", came from infinity";
  return formatted(", moved %.3g m", (run.start->head<3>() / a - run.end->head<3>() / b).norm());
}

}  // namespace

std::vector<FitTrace> traceFits(const Inspection& inspection, const HighlightModel& model, const ProgressFn& progress) {
  std::map<FitKey, Fold> folds;
  for (std::size_t i = 0; i < inspection.views.size(); ++i) {
    const TrainingView& v = inspection.views[i];
    if (!v.seen) continue;
    Fold& fold = folds[inspection.keyFor(v.frame, v.highlight.light)];
    fold.inspection = &inspection;
    if (fold.others.empty()) fold.left = inspection.viewAsGiven(int(i));  // says whose light and surface these are
    fold.others.push_back(inspection.viewAsGiven(int(i)));
  }
  std::vector<FitTrace> traces;
  for (auto& [key, fold] : folds) {
    if (!report(progress, {"fit", int(traces.size()), int(folds.size())})) throw Stopped{};
    SolverTrace trace;
    const Outcome<ModelFit> fit = fitFold(fold, model, inspection.request.settings, PoorFits::Take, progress);
    traces.push_back({key, trace.runs(), fit ? std::nullopt : std::optional(fit.failure())});
  }
  return traces;
}

std::vector<std::string> textOf(const FitTrace& trace) {
  std::vector<std::string> lines, kinds;
  for (const SolverRun& run : trace.runs)
    if (std::find(kinds.begin(), kinds.end(), run.what) == kinds.end()) kinds.push_back(run.what);
  for (const std::string& kind : kinds) {
    int runs = 0, steps = 0;
    const SolverRun *taken = nullptr, *last = nullptr;
    for (const SolverRun& run : trace.runs) {
      if (run.what != kind) continue;
      ++runs;
      steps += run.steps();
      last = &run;
      if (run.answer) taken = &run;
    }
    const SolverRun& shown = taken ? *taken : *last;
    std::string text = kind + ": ";
    if (runs > 1) text += formatted("%d runs, %d steps; the %s: ", runs, steps, taken ? "one that was taken" : "last one");
    lines.push_back(text + costText(shown) + movedText(shown) + "; " + shown.ending);
  }
  return lines;
}

}  // namespace glint
