// SPDX-License-Identifier: BSD-3-Clause
#include "core/report/share.h"

#include "cli/commands.h"
#include "cli/inspection_arguments.h"
#include "core/base/version.h"
#include "core/report/evaluation.h"
#include "core/report/texts.h"
#include "core/scene/frame_name.h"
#include "core/scene/outputs.h"

namespace glint::cli {
namespace {

struct ShareArguments : InspectionArguments {
  std::string frames, out;
};

/// What the session showed last; nothing of another input.
SessionView savedView(const std::string& input) {
  return std::filesystem::path(input).extension() == ".glint" ? readSession(input).view : SessionView{};
}

bool anyFit(const Inspection& inspection) {
  for (const auto& [name, model] : inspection.models)
    for (const ModelResult::Fit& fit : model.fits)
      if (fit.fit) return true;
  return false;
}

int runShare(const ShareArguments& a, const Context& context) {
  if (a.out == "-") throw InputError("", "--out -", "a page is written to a file");
  InspectionRequest request = a.request();
  ReportContext report;
  const std::shared_ptr<const Scene> scene = a.scene(request, &report.levelReason);
  for (const std::string& w : scene->warnings) context.warn(w);
  if (scene->frames.empty()) throw CannotAnswer{{Reason::TooFewViews, a.input + ": the scene has no frames"}};
  Outputs(a.input, *scene).file(a.out, "--out", OutputKind::page());
  ShareChoice choice;
  if (!a.frames.empty()) choice.frames = parseFrames(a.frames, *scene, "--frames");
  choice.view = savedView(a.input);
  report.input = a.input;
  report.program = "glint " GLINT_VERSION;
  const Evaluation e = evaluate(scene, request, report, {a.models == "auto", {}, a.sets("predict.query")}, context.progress());
  for (const std::string& w : warningsOf(e.inspection)) context.warn(w);
  // Where every frame trains, nothing is scored, and there is much to see all the same.
  if (e.failure && !anyFit(e.inspection)) throw CannotAnswer{*e.failure};
  if (e.failure) context.warn(e.failure->message());
  context.write(a.out, sharePage(e.inspection, e.report, choice, context.progress()));
  warnOfUnusedTrainingFrames(e.inspection, context);
  const int frames = static_cast<int>(scene->frames.size());
  if (choice.frames.empty() && frames > kMostSharedFrames)
    context.warn("the page shows " + std::to_string(kMostSharedFrames) + " of " + std::to_string(frames) +
                 " frames; --frames chooses others");
  return kDone;
}

}  // namespace

Command shareCommand() {
  const auto a = std::make_shared<ShareArguments>();
  Command c;
  c.name = "share";
  c.summary = "Write one HTML page to hand out: the scene in 3D, photographs, errors";
  c.description =
      "Does what evaluate does and writes one file that opens in any browser and needs no network: the scene in 3D\n"
      "(surface, cameras with their photographs, virtual cameras, tangent planes, canonical ellipses, ellipsoids,\n"
      "contours, lights), each photograph with observed and predicted contours, a slider through the frames, the errors\n"
      "of each model and frame, and of a lesson its steps. Photographs are made smaller where all of them together would\n"
      "be large, and a fine mesh is drawn with fewer triangles; the numbers are those of evaluate --json, without times.";
  c.examples =
      "  glint share scene.json -o page.html                      every model, every frame\n"
      "  glint share run.glint --models canonical,dual -o p.html  a session with two of its models\n"
      "  glint share scene.json --frames 0-20 -o p.html           chosen frames; all of them are evaluated\n";
  c.declare = [a](Options& o) {
    a->declare(o, "Models to compare: " + modelNames() + "; or auto (default: the session's, else all)");
    o.option(a->frames, "--frames", "SPEC", "Frames of the page: numbers, ids or ranges (default: all, at most 300)");
    o.required(a->out, "-o,--out", "HTML", "The page to write");
  };
  c.run = [a](const Context& context) { return runShare(*a, context); };
  return c;
}

}  // namespace glint::cli
