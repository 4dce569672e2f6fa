// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/observation.h"

#include <algorithm>
#include <iterator>
#include <utility>
#include <vector>

#include "core/pipeline/corrected_depth.h"
#include "core/pipeline/evidence.h"
#include "core/pipeline/hand_edits.h"
#include "core/pipeline/highlight_motion.h"
#include "core/pipeline/lobe_stage.h"
#include "core/pipeline/stage_inputs.h"
#include "core/surface/mesh_policy.h"

namespace glint {

std::optional<Observation> observeFrame(std::shared_ptr<const Scene> scene, const InspectionRequest& request, int frame,
                                        const ProgressFn& progress, const Inspection* known) {
  require(scene && frame >= 0 && frame < static_cast<int>(scene->frames.size()), "observeFrame: no such frame");
  if (lightsAreOpenIn(*scene, request)) return std::nullopt;
  Observation seen;
  seen.inputs.evidence = evidenceInputs(request, false);
  if (known && known->given == scene && known->evidenceOf(frame, seen.inputs)) return std::nullopt;
  const WhatIf& w = request.whatIf;
  const std::vector<int> alone{frame};
  seen.given = scene;
  seen.scene = w.changesScene() ? changedScene(*scene, w, seen.inputs.evidence->detect.level, progress, &alone) : scene;
  if (known && known->given == scene && known->lightFrame.frame != LightFrame::World)
    seen.scene = std::make_shared<const Scene>(inLightFrame(*seen.scene, known->lightFrame.frame));
  seen.request = request;
  seen.frame = frame;
  if (!report(progress, {"detect", 0, 1})) throw Stopped{};
  // Only all frames tell texture, and what lies under highlights; what that was before most likely still is.
  const FrameEvidence* const before = known && known->given == scene ? &known->evidence[std::size_t(frame)] : nullptr;
  seen.evidence = evidenceFor(*seen.scene, frame, *seen.inputs.evidence,
                              before && seen.inputs.evidence->detect.texture ? before->diffuse : nullptr);
  if (before && seen.inputs.evidence->detect.motion == MotionUse::Reject) dropTextures(seen.evidence, before->textures);
  if (known && known->given == scene && known->surfaces && seen.inputs.evidence->detect.background == BackgroundUse::Lobe) {
    // The lobes of the earlier results, where the request would find the same ones.
    const auto surface = known->surfaces->surfaceOf(frame, meshPolicy(request.settings));
    if (known->inputs.lobes == lobeInputs(request, known->train, false) && surface)
      if (std::optional<FrameEvidence> again =
              contouredAgain(*known, *seen.scene, *seen.inputs.evidence, frame, seen.evidence, *surface))
        seen.evidence = *std::move(again);
  }
  applyEdits(seen.evidence, *seen.scene, request);
  moveHighlights(seen.evidence, w);
  dropSwitchedOff(seen.evidence, w);
  return seen;
}

Inspection besideObservation(const Inspection& earlier, const Observation& observation) {
  require(earlier.given == observation.given, "besideObservation: results of another scene");
  const int frame = observation.frame;
  Inspection r;
  r.scene = observation.scene;
  r.given = observation.given;
  r.world = earlier.world;
  r.lightFrame = earlier.lightFrame;
  r.surfaces = earlier.surfaces;
  r.request = observation.request;
  r.train = earlier.train;
  r.evidence.resize(observation.scene->frames.size());
  r.evidence[std::size_t(frame)] = observation.evidence;
  std::copy_if(earlier.views.begin(), earlier.views.end(), std::back_inserter(r.views),
               [&](const TrainingView& v) { return v.frame == frame; });
  r.lights = earlier.lights;
  r.corrections = earlier.corrections;
  r.correctedDepthMaps = std::make_shared<CorrectedDepthMaps>();  // the frame may have moved
  r.inputs = observation.inputs;
  for (const auto& [name, before] : earlier.models) {
    ModelResult& now = r.models[name];
    now.model = before.model;
    now.fits = before.fits;
    now.oneFrame = true;
    for (const FrameComparison& c : before.frames) {
      if (c.frame != frame || !isOn(*observation.scene, observation.request.whatIf, frame, c.light)) continue;
      now.frames.push_back({c.frame, c.light, c.fit, c.prediction, {}, 0});
    }
  }
  return r;
}

}  // namespace glint
