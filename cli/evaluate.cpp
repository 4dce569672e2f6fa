// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include "cli/commands.h"
#include "cli/inspection_arguments.h"
#include "core/base/number_text.h"
#include "core/base/version.h"
#include "core/inspect/shard.h"
#include "core/inspect/summary.h"
#include "core/report/evaluation_part.h"
#include "core/report/report.h"
#include "core/report/warnings.h"
#include "core/scene/outputs.h"
#include "core/selection/selection.h"

namespace glint::cli {

Command evaluateCommand() {
  struct Arguments : InspectionArguments {
    std::string json, csv, html, goodEnough, shard;
  };
  const auto a = std::make_shared<Arguments>();
  Command c;
  c.name = "evaluate";
  c.summary = "Fit models to training frames, predict held-out frames and compare";
  c.description =
      "Finds the highlights in every frame, fits each model to the training frames, predicts every frame and compares\n"
      "predictions with observations. The table covers held-out frames only (all frames with --train per-surface). Errors\n"
      "are symmetric mean contour distances in pixels and in percent of the equivalent diameter of the observed highlight;\n"
      "predicted/frames and coverage are shown beside them, so that no model wins by leaving highlights out.\n"
      "--models auto chooses the simplest model whose leave-one-view-out error on the training frames is within one\n"
      "standard error of the best, or under --good-enough-pct. If walks on local quadrics are good enough by the same\n"
      "rule, predict.query becomes local-quadric, unless --set gives it.";
  c.examples =
      "  glint evaluate scene.json                                all models, trained on the first 6 frames\n"
      "  glint evaluate scene.json --train spread:6 --html r.html a page with plots and the worst frames\n"
      "  glint evaluate scene.json --models auto --good-enough-pct 0.5\n"
      "  glint evaluate scene.json --train 0-5 --json - --set fit.solver=anchored\n"
      "  glint evaluate scene.json --shard 2/8 --json part-2.json the second eighth of the frames, for glint merge\n";
  c.declare = [a](Options& o) {
    a->declare(o, "Models to compare: " + modelNames() + "; or auto (default: all)");
    o.option(a->goodEnough, "--good-enough-pct", "E", "With --models auto: contour error in percent that is good enough");
    o.option(a->json, "--json", "FILE", "Write the whole evaluation as JSON (- = standard output)");
    o.option(a->csv, "--csv", "FILE", "Write CSV, one row per model, frame and highlight (- = standard output)");
    o.option(a->html, "--html", "FILE", "Write a self-contained HTML page");
    o.option(a->shard, "--shard", "i/n",
             "Score the i-th of n equal parts of the frames; --json FILE is a part for `glint merge`");
  };
  c.run = [a](const Context& context) -> int {
    const std::optional<Shard> shard = shardOf(a->shard, *a, a->json, {{"--csv", a->csv}, {"--html", a->html}});
    InspectionRequest request = a->request();
    ReportContext report;
    const std::shared_ptr<const Scene> scene = a->scene(request, &report.levelReason);
    for (const std::string& w : scene->warnings) context.warn(w);
    Outputs outputs(a->input, *scene);
    outputs.file(a->json, "--json", OutputKind::document("glint_evaluation"));
    outputs.file(a->csv, "--csv", OutputKind::table(kEvaluationCsvHeader));
    outputs.file(a->html, "--html", OutputKind::page());
    report.input = a->input;
    report.program = "glint " GLINT_VERSION;
    if (shard) {
      const Inspection part = inspectShard(scene, request, *shard, context.progress());
      context.write(a->json, evaluationPart(part, report, *shard, context.progress()));
      warnOfUnusedTrainingFrames(part, context);
      return kDone;  // whether a model answers is known when all parts are merged
    }
    Inspection result;
    std::string text = report.levelReason.empty() ? "" : report.levelReason + "\n\n";
    // What was asked for on standard output must stay parseable there: the table then stays away.
    const bool tableToo = a->json != "-" && a->csv != "-" && a->html != "-";
    const auto write = [&] {
      if (!a->json.empty()) context.write(a->json, evaluationJson(result, report));
      if (!a->csv.empty()) context.write(a->csv, evaluationCsv(result));
      if (!a->html.empty()) context.write(a->html, evaluationHtml(result, report));
      for (const std::string& w : warningsOf(result)) context.warn(w);
    };
    if (a->models == "auto") {
      std::optional<double> goodEnough;
      if (!a->goodEnough.empty()) {
        goodEnough = numberFrom(a->goodEnough);
        if (!goodEnough || !(*goodEnough > 0))
          throw InputError("", "--good-enough-pct " + a->goodEnough, "expected a positive number, in percent");
      }
      request.models.clear();  // evidence and views only: the choice decides what else is computed
      result = inspect(scene, request, context.progress());
      if (noUsableView(result)) {  // the JSON says so too, with the reason of every training frame
        report.whyChosen = noUsableView(result)->message();
        write();
        throw CannotAnswer{*noUsableView(result)};
      }
      const Selection s = selectModel(result, goodEnough, context.progress());
      text += selectionTable(s) + "\n";
      report.selection = s;
      if (s.model.empty()) {
        report.whyChosen = s.why;
        write();
        if (tableToo) context.print(text);
        throw CannotAnswer{{Reason::NotReached, s.why}};
      }
      const bool keepWalks = a->sets("predict.query");  // the user decided
      if (keepWalks && s.patches && s.patches->goodEnough) text += "predict.query stays as set.\n\n";
      request = chosenRequest(request, s);
      if (keepWalks) request.settings.set("predict.query", result.request.settings.text("predict.query"));
      report.chosenModel = s.model;
      report.whyChosen = s.why + (s.patches ? " " + s.patches->why : "");
      result = inspect(scene, request, context.progress(), &result);
    } else {
      result = inspect(scene, request, context.progress());
      const BestModel best = bestModel(result);
      report.chosenModel = best.model;
      report.whyChosen = best.why;
    }
    write();
    if (tableToo) context.print(text + evaluationTable(result));
    for (const auto& [name, model] : result.models) {
      if (!summarise(result, model).answered) continue;
      warnOfUnusedTrainingFrames(result, context);
      return kDone;
    }
    requireUsableViews(result);
    std::string reasons;
    for (const auto& [name, model] : result.models)
      reasons += (reasons.empty() ? "" : "; ") + name + ": " + summarise(result, model).reason;
    throw CannotAnswer{{Reason::NotReached, "no model answered; " + reasons}};
  };
  return c;
}

}  // namespace glint::cli
