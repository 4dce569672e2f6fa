// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "cli/commands.h"
#include "cli/inspection_arguments.h"
#include "cli/predict_stream.h"
#include "core/app/session.h"
#include "core/base/atomic_file.h"
#include "core/base/number_text.h"
#include "core/base/progress.h"
#include "core/highlight/report.h"
#include "core/pipeline/photograph.h"
#include "core/pipeline/summary.h"
#include "core/report/labels.h"
#include "core/report/masks.h"
#include "core/report/texts.h"
#include "core/scene/frame_name.h"
#include "core/scene/outputs.h"
#include "viz/pictures.h"

namespace glint::cli {
namespace {

constexpr int kPictureWidth = 1280, kPictureHeight = 960;

std::string predictionTable(const Inspection& inspection, const std::vector<int>& frames) {
  std::string out = formatted("%-12s %-16s %-10s %10s %9s  %s\n", "model", "frame", "light", "highlights", "coverage", "reason");
  for (const std::string& name : inspection.request.models)
    for (const FrameComparison& c : inspection.models.at(name).frames) {
      if (std::find(frames.begin(), frames.end(), c.frame) == frames.end()) continue;
      double coverage = 0;
      for (const PredictedHighlight& h : c.prediction.highlights())
        coverage += h.coverage / double(c.prediction.highlights().size());
      const std::string poor = poorFit(inspection.models.at(name), c);
      const std::string reason = !c.prediction.highlights().empty() ? (poor.empty() ? "" : poorWarning(poor))
                                 : c.prediction.failure()           ? c.prediction.failure()->message()
                                                                    : "";
      out += formatted("%-12s %-16s %-10s %10zu %9.3f  ", name.c_str(), frameName(*inspection.scene, c.frame).c_str(),
                       c.light.c_str(), c.prediction.highlights().size(), coverage) +
             reason + "\n";
    }
  return out;
}

struct PredictArguments {
  std::string session, frames, exclude, out, json, preset, masks, labels, poses;
  std::vector<std::string> set, lights;
  bool stream = false;
  SceneArguments places;
  /// Bands take several fits: a user who wants none gets none.
  bool saysBand() const {
    return std::any_of(set.begin(), set.end(), [](const std::string& entry) { return entry.rfind("predict.band=", 0) == 0; });
  }
  /// One answer a line leaves no room for others; poses come live or not at all.
  void requireOneKindOfAnswer() const {
    if (!labels.empty() && out.empty()) throw InputError("", "--labels", "needs --out DIR, the new folder for the labels");
    if (!stream && !poses.empty())
      throw InputError("", "--poses", "needs --stream: without it the scene's own frames are predicted");
    for (const auto& [given, flag] : {std::pair(&frames, "--frames"), std::pair(&out, "--out"), std::pair(&masks, "--masks"),
                                      std::pair(&labels, "--labels"), std::pair(&json, "--json")})
      if (stream && !given->empty())
        throw InputError("", flag, "cannot be combined with --stream, which answers on standard output");
  }
};

/// Contours, overlays and labels, whole or not at all.
void writeFolder(const std::string& out, const Inspection& result, const std::vector<int>& frames, const Context& context) {
  atomicFiles(out, "predictions.json", [&](const std::filesystem::path& folder) {
    parallelFor(
        static_cast<int>(frames.size()),
        [&](int i) {
          writePng(folder / pictureName(result.scene->frames[static_cast<std::size_t>(frames[i])]),
                   viz::framePicture(result, frames[i], photographOf(result, frames[i]), kPictureWidth, kPictureHeight));
        },
        context.progress(), "overlays");
    context.write((folder / "predictions.json").string(), predictionsJson(result, frames));
    for (const std::string& model : result.request.models)
      context.write((folder / ("labels_" + model + ".json")).string(), cocoJson(result, model, frames));
  });
}

/// CannotAnswer with the first reason where no model predicts a highlight in these frames.
void requireAnyHighlight(const Inspection& result, const std::vector<int>& frames) {
  std::string reason;
  for (const auto& [name, model] : result.models)
    for (const FrameComparison& f : model.frames) {
      if (std::find(frames.begin(), frames.end(), f.frame) == frames.end()) continue;
      if (!f.prediction.highlights().empty()) return;
      if (reason.empty() && f.prediction.failure()) reason = name + ": " + f.prediction.failure()->message();
    }
  requireUsableViews(result);
  throw CannotAnswer{{Reason::NotReached, "no highlight was predicted; " + reason}};
}

int run(const PredictArguments& a, const Context& context) {
  a.requireOneKindOfAnswer();
  const std::optional<LabelFormats> formats = a.labels.empty() ? std::nullopt : std::optional(labelFormatsFrom(a.labels));
  const OpenedSession opened = a.places.openSession(a.session);
  for (const std::string& w : opened.session.warnings) context.warn(w);
  if (!opened.warning.empty()) context.warn(opened.warning);
  InspectionRequest request = opened.session.request;
  if (!a.preset.empty()) applyPreset(opened.session, a.preset, request);
  applyEach(request.settings, a.set);
  exclude(a.exclude, *opened.scene, request);
  request.lights = a.lights;
  if (a.stream) return answerPoses(opened, request, a.poses, context);
  const Scene& scene = *opened.scene;
  std::vector<int> frames;
  if (!a.frames.empty())
    frames = parseFrames(a.frames, scene, "--frames");
  else
    for (int i = 0; i < static_cast<int>(scene.frames.size()); ++i) frames.push_back(i);
  Outputs outputs(a.session, scene);
  outputs.file(a.json, "--json", OutputKind::document("glint_predictions"));
  std::vector<std::string> names = picturesOf(scene, frames);
  for (const std::string& model : opened.session.request.models) names.push_back("labels_" + model + ".json");
  names.emplace_back("predictions.json");
  if (!formats) outputs.inFolder(a.out, "--out", names, "predictions.json", "glint_predictions");
  const bool shows = (!a.out.empty() && !formats) || !a.json.empty();
  if (shows && !a.saysBand()) request.settings.set("predict.band", true);
  const Inspection result = inspect(opened.scene, request, context.progress());
  requireLights(result);
  if (formats) writeLabels(result, a.out, context.progress(), *formats, frames);
  if (!a.out.empty() && !formats) writeFolder(a.out, result, frames, context);
  if (!a.masks.empty()) writeLabels(result, a.masks, context.progress());
  if (!a.json.empty()) context.write(a.json, predictionsJson(result, frames));
  if (a.json != "-") context.print(predictionTable(result, frames));
  for (const std::string& w : warningsOf(result)) context.warn(w);
  requireAnyHighlight(result, frames);
  warnOfUnusedTrainingFrames(result, context);
  return kDone;
}

}  // namespace

Command predictCommand() {
  const auto a = std::make_shared<PredictArguments>();
  Command c;
  c.name = "predict";
  c.summary = "Predict highlights with a saved session: contours, overlays, labels";
  c.description =
      "Opens a session, refits its models and predicts the highlights of the selected frames. --out writes predictions.json\n"
      "(contours in ideal pixels with their standard deviations, brightest points, coverage, failed directions with reasons),\n"
      "one overlay PNG per frame, and labels_MODEL.json in COCO format for each model. --set predict.band=false leaves the\n"
      "standard deviations out, which take several fits.\n"
      "With --labels, --out is a new folder with labels alone: labels_MODEL.json (coco), masks/, yolo/MODEL/.\n"
      "--stream answers poses instead: for each line that it reads, JSON {\"id\", \"time\", \"camera_from_world\", \"camera\"} "
      "or TUM\n"
      "(time tx ty tz qx qy qz qw), it writes one line of JSON at once, until the input ends. A wrong line is answered with an\n"
      "error, and the stream goes on. With --set predict.band=true contours have their standard deviations.";
  c.examples =
      "  glint predict run.glint                       a table of all frames\n"
      "  glint predict run.glint --frames 6-20 --out predicted\n"
      "  glint predict run.glint --labels coco,yolo --out labels\n"
      "  glint predict dome.glint --light dome-13        a known lamp that no photograph shows\n"
      "  tracker | glint predict run.glint --preset balanced --stream | viewer\n";
  c.declare = [a](Options& o) {
    o.positional(a->session, "FILE.glint", "A session written by `glint reconstruct` or the inspector");
    o.option(a->frames, "--frames", "SPEC", "Frames to predict: numbers, ids, ranges, first:K or spread:K (default: all)");
    o.option(a->exclude, "--exclude", "SPEC", kExcludeHelp);
    o.repeated(a->lights, "--light", "ID", "Predict this light, fitted or known, whether it is on or not; may be repeated");
    o.option(a->preset, "--preset", "NAME",
             "Take model and settings from the session's trade-off: fast, balanced, exact or chosen");
    o.option(a->out, "--out", "DIR", "Write contours, overlays and labels to this folder");
    o.option(a->masks, "--masks", "DIR", "Write masks and COCO labels of all frames to this new folder");
    o.option(a->labels, "--labels", "LIST",
             "Write labels to --out, a new folder, instead of contours and overlays: coco, masks, yolo, separated by commas");
    o.option(a->json, "--json", "FILE", "Write predictions.json to this file (- = standard output, replaces the table)");
    o.repeated(a->set, "--set", "KEY=VALUE", "Any setting by its dotted name; may be repeated");
    o.flag(a->stream, "--stream", "Answer each pose that is read by one line of JSON on standard output");
    o.option(a->poses, "--poses", "FILE", "With --stream: the poses, as JSON or TUM lines (default, and -: standard input)");
    a->places.declareForSession(o);
  };
  c.run = [a](const Context& context) { return run(*a, context); };
  return c;
}

}  // namespace glint::cli
