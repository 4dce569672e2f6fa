// SPDX-License-Identifier: BSD-3-Clause
#include "cli/commands.h"
#include "cli/inspection_arguments.h"
#include "core/base/number_text.h"
#include "core/diagnose/diagnosis.h"
#include "core/diagnostics/camera_check.h"
#include "core/inspect/summary.h"
#include "core/report/diagnosis_report.h"
#include "core/scene/outputs.h"

namespace glint::cli {

Command diagnoseCommand() {
  struct Arguments : InspectionArguments {
    std::string json;
    int most = DiagnoseOptions{}.mostTried;
    bool thorough = false;
  };
  const auto a = std::make_shared<Arguments>();
  Command c;
  c.name = "diagnose";
  c.summary = "Say why a model fails or is poor, and measure what helps";
  c.description =
      "Fits each model to the training frames and judges it by views that its fit did not see: each training view by a fit\n"
      "without it, and up to 10 held-out frames. For a model that fails, or is off by more than 5 %, it says why, names the\n"
      "highlights that stand against it, and measures what helps: other models, solvers, training frames, exclusions and\n"
      "settings. A change is listed only if that error falls by more than chance.\n"
      "Exit code 3 if no model could be fitted; --json is written all the same.";
  c.examples =
      "  glint diagnose scene.json                                all models, trained on the first 6 frames\n"
      "  glint diagnose session.glint --model canonical --json -  one model, as JSON\n"
      "  glint diagnose scene.json --most 4                       a quick look: four changes for each model\n";
  c.declare = [a](Options& o) {
    a->declare(o, "Models to diagnose: " + modelNames() + " (default: all)");
    o.option(a->json, "--json", "FILE", "Write the whole diagnosis as JSON (- = standard output)");
    o.option(a->most, "--most", "N", "Measure at most N changes for each model that is not ok");
    o.flag(a->thorough, "--thorough", "Try other training frames and contours, too, where something faster has helped enough");
  };
  c.run = [a](const Context& context) -> int {
    if (a->models == "auto") throw InputError("", "--models auto", "name the models to diagnose");
    if (a->most < 0) throw InputError("", "--most", "must not be negative");
    InspectionRequest request = a->request();
    const std::shared_ptr<const Scene> scene = a->scene(request);
    for (const std::string& w : scene->warnings) context.warn(w);
    Outputs outputs(a->input, *scene);
    outputs.file(a->json, "--json", OutputKind::document("glint_diagnosis"));
    const Inspection inspection = inspect(scene, request, context.progress());
    DiagnoseOptions options;
    options.mostTried = a->most;
    options.slowToo = a->thorough;
    const Diagnosis diagnosis = diagnose(inspection, options, context.progress());
    // What the input gets wrong no other model or setting puts right: it stands first.
    const ConventionReport input = fullReport(*scene, context.progress());
    if (!a->json.empty()) context.write(a->json, withFindings(diagnosisJson(inspection, diagnosis, a->input), input));
    if (a->json != "-") context.print(findingsText(input) + diagnosisText(inspection, diagnosis));
    warnOfUnusedTrainingFrames(inspection, context);
    std::string reasons;
    for (const ModelDiagnosis& d : diagnosis.models) {
      if (d.status != ModelDiagnosis::Status::Failed) return kDone;
      reasons += (reasons.empty() ? "" : "; ") + d.model + ": " + (d.causes.empty() ? "" : d.causes.front());
    }
    throw CannotAnswer{Failure{Reason::NotReached, "no model could be fitted; " + reasons}};
  };
  return c;
}

}  // namespace glint::cli
