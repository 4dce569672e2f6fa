// SPDX-License-Identifier: BSD-3-Clause
#include <QCoreApplication>
#include <filesystem>

#include "core/advise/camera_check.h"
#include "core/app/tradeoff_run.h"
#include "gui/document/engine.h"
#include "gui/document/session_file.h"

namespace glint::gui {

Engine coreEngine() {
  Engine engine;
  engine.open = openInput;
  engine.save = saveSession;
  engine.autosave = autosaveSession;
  engine.recoveryText = recoveryText;
  engine.ask = [](Pipeline& pipeline, const Question& question, const ProgressFn& progress) {
    return pipeline.ask(question, progress);
  };
  engine.contour = [](const Pipeline& pipeline, const InspectionRequest& request, int frame, const ProgressFn& progress,
                      const Inspection* shown) { return pipeline.contour(request, frame, progress, shown); };
  engine.choose = [](std::shared_ptr<const Scene> scene, InspectionRequest request, std::optional<double> goodEnoughPct,
                     const ProgressFn& progress, const Inspection* previous) {
    request.models.clear();                   // evidence and views alone
    request.settings.reset("predict.query");  // decided anew, whatever an earlier choice set
    return selectModel(inspect(std::move(scene), request, progress, previous), goodEnoughPct, progress);
  };
  engine.tradeoff = [](std::shared_ptr<const Scene> scene, InspectionRequest request, const std::string& file,
                       const ProgressFn& progress) {
    request.models.clear();
    for (const auto& model : allModels()) request.models.push_back(model->id());
    TradeoffOptions options;
    options.input = file;
    // Beside a session file, whose folder the user writes to anyway.
    if (std::filesystem::path(file).extension() == ".glint") options.workFile = file + ".work";
    options.program = "glint-inspector " + QCoreApplication::applicationVersion().toStdString();
    Tradeoff t = measureTradeoff(std::move(scene), request, options, progress);
    std::error_code ignored;
    if (!options.workFile.empty()) std::filesystem::remove(options.workFile, ignored);
    return t;
  };
  engine.influence = [](const Inspection& inspection, const ProgressFn& progress) {
    return measureInfluence(inspection, progress);
  };
  engine.check = [](const Scene& scene, const ProgressFn& progress) { return fullReport(scene, progress); };
  engine.lamps = [](std::shared_ptr<const Scene> scene, const InspectionRequest& request, const std::string& input,
                    const ProgressFn& progress, const Inspection* previous) {
    const InspectionRequest asked = lampsRequest(request, *scene);
    return lampsReportOf(inspect(std::move(scene), asked, progress, previous), input, progress);
  };
  engine.ballLamps = [](const BallQuestion& question, const ProgressFn& progress) {
    return lampsReportOf(question, ballShotsIn(question.input, question.balls, question.exclude), progress);
  };
  engine.parseTrain = parseTrainSpec;
  return engine;
}

}  // namespace glint::gui
