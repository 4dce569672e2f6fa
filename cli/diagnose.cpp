// SPDX-License-Identifier: BSD-3-Clause
#include "cli/commands.h"
#include "cli/inspection_arguments.h"
#include "core/advise/camera_check.h"
#include "core/advise/diagnosis.h"
#include "core/base/number_text.h"
#include "core/base/version.h"
#include "core/pipeline/summary.h"
#include "core/report/report.h"
#include "core/scene/outputs.h"

namespace glint::cli {
namespace {

constexpr int kEvery = 1000;  // changes: more than there are

std::string pageOf(const Inspection& inspection, const Diagnosis& diagnosis, const std::string& input) {
  ReportContext page;
  page.input = input;
  page.chosenModel = diagnosis.present;
  page.advice = adviceOf(diagnosis);
  page.program = "glint " GLINT_VERSION;
  return evaluationHtml(inspection, page);
}

}  // namespace

Command diagnoseCommand() {
  struct Arguments : InspectionArguments {
    std::string json, html;
    int most = DiagnoseOptions{}.mostTried;
    bool thorough = false;
  };
  const auto a = std::make_shared<Arguments>();
  Command c;
  c.name = "diagnose";
  c.summary = "Say which model and which settings predict best, measured, and why the others fail";
  c.description =
      "Compares the models in the held-out frames (where none shows a highlight: in training frames that are left out), then\n"
      "measures what helps the best ones: settings, training frames, exclusions, filters. Ends in one verdict and at most three\n"
      "remedies that beat the present state: the one model that was asked for, else the best of those. The evidence is\n"
      "below: why models fail or are poor, and where --models auto would choose otherwise.\n"
      "Exit code 3 if no model could be fitted; --json is written all the same.";
  c.examples =
      "  glint diagnose scene.json                                which model is best, and what makes it better\n"
      "  glint diagnose session.glint --model canonical --json -  what beats this model, as JSON\n"
      "  glint diagnose scene.json --most 0                       a quick look: only models are compared\n";
  c.declare = [a](Options& o) {
    a->declare(o, "Models to diagnose: " + modelNames() + " (default: all)");
    o.option(a->json, "--json", "FILE", "Write the whole diagnosis as JSON (- = standard output)");
    o.option(a->html, "--html", "FILE", "Write a self-contained HTML page: the evaluation with this advice on top");
    o.option(a->most, "--most", "N", "Measure at most N changes of the best model, and a third as many of others");
    o.flag(a->thorough, "--thorough", "Measure every known change");
  };
  c.run = [a](const Context& context) -> int {
    if (a->models == "auto") throw InputError("", "--models auto", "name the models to diagnose");
    if (a->most < 0) throw InputError("", "--most", "must not be negative");
    InspectionRequest request = a->request();
    const std::shared_ptr<const Scene> scene = a->scene(request);
    for (const std::string& w : scene->warnings) context.warn(w);
    Outputs outputs(a->input, *scene);
    outputs.file(a->json, "--json", OutputKind::document("glint_diagnosis"));
    outputs.file(a->html, "--html", OutputKind::page());
    const Inspection inspection = inspect(scene, request, context.progress());
    DiagnoseOptions options;
    options.mostTried = a->thorough ? kEvery : a->most;
    if (inspection.request.models.size() == 1) options.present = inspection.request.models.front();
    const Diagnosis diagnosis = diagnose(inspection, options, context.progress());
    // No other model or setting corrects a wrong input, so its findings come first.
    const ConventionReport input = fullReport(*scene, context.progress());
    if (!a->json.empty()) context.write(a->json, withFindings(diagnosisJson(inspection, diagnosis, a->input), input));
    if (!a->html.empty()) context.write(a->html, pageOf(inspection, diagnosis, a->input));
    if (a->json != "-" && a->html != "-") context.print(findingsText(input) + diagnosisText(inspection, diagnosis));
    warnOfUnusedTrainingFrames(inspection, context);
    std::string reasons;
    for (const ModelDiagnosis& d : diagnosis.models) {
      if (d.status != "failed" || d.error.matched() > 0) return kDone;
      reasons += (reasons.empty() ? "" : "; ") + d.model + ": " + (d.causes.empty() ? "" : d.causes.front());
    }
    throw CannotAnswer{Failure{Reason::NotReached, "no model could be fitted; " + reasons}};
  };
  return c;
}

}  // namespace glint::cli
