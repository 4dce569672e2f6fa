// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/stage_inputs.h"

#include "core/pipeline/inspection.h"
#include "core/pipeline/lobe_stage.h"

namespace glint {

bool StageInputs::same(Stage stage, const StageInputs& other) const {
  const auto equal = [](const auto& a, const auto& b) { return a && a == b; };
  switch (stage) {
    case Stage::Evidence: return equal(evidence, other.evidence);
    case Stage::Lobes: return equal(lobes, other.lobes);
    case Stage::Views: return same(Stage::Evidence, other) && same(Stage::Lobes, other) && equal(views, other.views);
    case Stage::Lights: return same(Stage::Views, other) && equal(lights, other.lights);
    case Stage::Fits: return same(Stage::Lights, other) && equal(fits, other.fits);
    case Stage::Predictions: break;
  }
  return same(Stage::Fits, other) && equal(predictions, other.predictions);
}

StageInputs StageInputs::upToLobes() const {
  StageInputs some;
  some.evidence = evidence;
  some.lobes = lobes;
  return some;
}

StageSettings settingsOf(const Settings& settings, const std::set<std::string>& stages) {
  StageSettings some;
  for (const auto& [name, value] : settings.values())
    if (stages.count(paramSpec(name).stage)) some.emplace(name, value);
  return some;
}

EvidenceInputs evidenceInputs(const InspectionRequest& request, bool together) {
  EvidenceInputs in;
  in.source = request.source;
  in.truthFolder = request.truthFolder;
  in.detect = request.settings;
  if (together) in.surface = settingsOf(request.settings, {"surface"});
  in.whatIf = synthesisOf(request.whatIf);
  if (together) in.whatIf.poses = request.whatIf.poses;
  return in;
}

TrainingInputs trainingInputs(const InspectionRequest& request, const TrainSpec& train) {
  return {train.frames, request.excluded, train.perSurface};
}

LobeInputs lobeInputs(const InspectionRequest& request, const TrainSpec& train, bool together) {
  constexpr double kHalf = 0.5;
  LobeInputs in;
  in.evidence = evidenceInputs(request, together);
  if (!together) in.evidence.detect = in.evidence.detect.at(kHalf);
  in.surface = settingsOf(request.settings, {"surface"});
  in.training = trainingInputs(request, train);
  in.whatIf.poses = request.whatIf.poses;
  in.whatIf.lightsSwitched = lightsOff(request.whatIf);
  in.whatIf.edits = request.whatIf.edits;
  std::erase_if(in.whatIf.edits, [](const HighlightEdit& e) { return e.kind != HighlightEdit::Kind::Ignore; });
  in.pixels = looksAtPixels(request);
  return in;
}

ViewInputs viewInputs(const InspectionRequest& request, const TrainSpec& train) {
  ViewInputs in;
  in.surface = settingsOf(request.settings, {"surface"});
  in.training = trainingInputs(request, train);
  in.noisePx = request.noisePx;
  in.seed = request.seed;
  in.whatIf.poses = request.whatIf.poses;
  in.whatIf.highlights = request.whatIf.highlights;
  in.whatIf.edits = request.whatIf.edits;
  in.whatIf.lightsSwitched = lightsOff(request.whatIf);
  if (request.settings.text("fit.evidence") == "levels") in.levels = request.settings.text("fit.levels");
  return in;
}

}  // namespace glint
