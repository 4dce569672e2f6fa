// SPDX-License-Identifier: BSD-3-Clause
#include "cli/commands.h"
#include "cli/inspection_arguments.h"
#include "core/base/number_text.h"
#include "core/base/version.h"
#include "core/report/evaluation.h"
#include "core/report/report.h"
#include "core/report/texts.h"
#include "core/scene/outputs.h"

namespace glint::cli {
namespace {

struct EvaluateArguments : InspectionArguments {
  std::string json, csv, html, goodEnough;
  std::optional<double> goodEnoughFrom() const {
    if (models != "auto" || goodEnough.empty()) return std::nullopt;
    const std::optional<double> percent = numberFrom(goodEnough);
    if (!percent || !(*percent > 0))
      throw InputError("", "--good-enough-pct " + goodEnough, "expected a positive number, in percent");
    return percent;
  }
};

int run(const EvaluateArguments& a, const Context& context) {
  InspectionRequest request = a.request();
  ReportContext report;
  const std::shared_ptr<const Scene> scene = a.scene(request, &report.levelReason);
  for (const std::string& w : scene->warnings) context.warn(w);
  Outputs outputs(a.input, *scene);
  outputs.file(a.json, "--json", OutputKind::document("glint_evaluation"));
  outputs.file(a.csv, "--csv", OutputKind::table(kEvaluationCsvHeader));
  outputs.file(a.html, "--html", OutputKind::page());
  report.input = a.input;
  report.program = "glint " GLINT_VERSION;
  const std::string levelText = report.levelReason.empty() ? "" : report.levelReason + "\n\n";
  const EvaluationQuestion question{a.models == "auto", a.goodEnoughFrom(), a.sets("predict.query")};
  const Evaluation e = evaluate(scene, request, report, question, context.progress());
  if (!a.json.empty()) context.write(a.json, evaluationJson(e.inspection, e.report));
  if (!a.csv.empty()) context.write(a.csv, evaluationCsv(e.inspection));
  if (!a.html.empty()) context.write(a.html, evaluationHtml(e.inspection, e.report));
  for (const std::string& w : warningsOf(e.inspection)) context.warn(w);
  if (e.report.selection && e.report.selection->poor) context.warn("auto: " + e.report.selection->why);
  // What was asked for on standard output must stay parseable there: the table then stays away.
  const bool tableToo = a.json != "-" && a.csv != "-" && a.html != "-";
  const std::string table = e.inspection.models.empty() ? "" : evaluationTable(e.inspection);
  if (tableToo && !(e.choice + table).empty()) context.print(levelText + e.choice + table);
  if (e.failure) throw CannotAnswer{*e.failure};
  warnOfUnusedTrainingFrames(e.inspection, context);
  return kDone;
}

}  // namespace

Command evaluateCommand() {
  const auto a = std::make_shared<EvaluateArguments>();
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
      "  glint evaluate scene.json --train 0-5 --json - --set fit.solver=anchored\n";
  c.declare = [a](Options& o) {
    a->declare(o, "Models to compare: " + modelNames() + "; or auto (default: all)");
    o.option(a->goodEnough, "--good-enough-pct", "E", "With --models auto: contour error in percent that is good enough");
    o.option(a->json, "--json", "FILE", "Write the whole evaluation as JSON (- = standard output)");
    o.option(a->csv, "--csv", "FILE", "Write CSV, one row per model, frame and highlight (- = standard output)");
    o.option(a->html, "--html", "FILE", "Write a self-contained HTML page");
  };
  c.run = [a](const Context& context) { return run(*a, context); };
  return c;
}

}  // namespace glint::cli
