// SPDX-License-Identifier: BSD-3-Clause
#include "core/report/evaluation.h"

#include "core/choice/selection.h"
#include "core/pipeline/summary.h"
#include "core/scene/frame_name.h"

namespace glint {
namespace {

std::optional<Failure> noModelAnswered(const Inspection& inspection) {
  std::string reasons;
  bool fitted = false;
  for (const auto& [name, model] : inspection.models) {
    const ModelSummary s = summarise(inspection, model);
    if (s.answered) return std::nullopt;
    for (const ModelResult::Fit& fit : model.fits) fitted = fitted || fit.fit;
    reasons += (reasons.empty() ? "" : "; ") + name + ": " + s.reason;
  }
  if (std::optional<Failure> none = noUsableView(inspection)) return none;
  if (inspection.models.empty()) return std::nullopt;  // none was asked for
  // Nothing is wrong with the models then: there is nothing to compare their predictions with.
  if (fitted && heldOutFrames(inspection).all == 0)
    return Failure{Reason::NotReached,
                   "every frame is used for training: none is held out to compare predictions with (see --train)"};
  return Failure{Reason::NotReached, "no model answered; " + reasons};
}

void choose(Evaluation& e, const std::shared_ptr<const Scene>& scene, InspectionRequest request,
            const EvaluationQuestion& question, const ProgressFn& progress, const Inspection* previous) {
  request.models.clear();  // evidence and views only: the choice decides what else is computed
  e.inspection = inspect(scene, request, progress, previous);
  e.failure = noUsableView(e.inspection);
  if (e.failure) {
    e.report.whyChosen = e.failure->message();
    return;
  }
  const Selection s = selectModel(e.inspection, question.goodEnoughPct, progress);
  e.choice = selectionTable(s) + "\n";
  e.report.selection = s;
  if (s.model.empty()) {
    e.report.whyChosen = s.why;
    e.failure = Failure{Reason::NotReached, s.why};
    // The best of what was refused is shown all the same.
    if (!s.best.empty()) e.inspection = inspect(scene, chosenRequest(std::move(request), s), progress, &e.inspection);
    return;
  }
  if (question.keepWalks && s.patches && s.patches->goodEnough) e.choice += "predict.query stays as set.\n\n";
  const std::string walks = request.settings.text("predict.query");
  request = chosenRequest(std::move(request), s);
  if (question.keepWalks) request.settings.set("predict.query", walks);
  e.report.chosenModel = s.model;
  e.report.whyChosen = s.why + (s.patches ? " " + s.patches->why : "");
  e.inspection = inspect(scene, request, progress, &e.inspection);
  e.failure = noModelAnswered(e.inspection);
}

}  // namespace

Evaluation evaluate(std::shared_ptr<const Scene> scene, InspectionRequest request, ReportContext report,
                    const EvaluationQuestion& question, const ProgressFn& progress, const Inspection* previous) {
  const PhotographsHeld held(*scene, parseTrainSpec(request.train, *scene).frames);  // the choice may look at them again
  Evaluation e;
  e.report = std::move(report);
  if (question.choose) {
    choose(e, scene, std::move(request), question, progress, previous);
    return e;
  }
  e.inspection = inspect(std::move(scene), request, progress, previous);
  const BestModel best = bestModel(e.inspection);
  e.report.chosenModel = best.model;
  e.report.whyChosen = best.why;
  e.failure = noModelAnswered(e.inspection);
  return e;
}

std::vector<std::string> unusedTrainingFrames(const Inspection& inspection) {
  std::vector<std::string> lines;
  for (const int frame : inspection.train.frames) {
    if (!inspection.isTraining(frame)) continue;
    std::optional<Failure> reason = inspection.evidence[frame].failure.value_or(Failure{Reason::NoHighlight, ""});
    for (const TrainingView& v : inspection.views) {
      if (v.frame != frame) continue;
      reason = v.failure();
      if (!reason) break;
    }
    if (reason) lines.push_back("frame " + frameName(*inspection.scene, frame) + ": " + reason->message());
  }
  return lines;
}

std::optional<Failure> noUsableView(const Inspection& inspection) {
  for (const TrainingView& v : inspection.views)
    if (v.seen) return std::nullopt;
  const std::vector<std::string> unused = unusedTrainingFrames(inspection);
  return Failure{Reason::TooFewViews, "no training frame could be used" + (unused.empty() ? "" : "; " + unused.front())};
}

}  // namespace glint
