// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <set>
#include <utility>

#include "core/pipeline/evidence.h"
#include "core/pipeline/hand_edits.h"

namespace glint {

FrameEvidence evidenceFor(const Scene& scene, int frame, const EvidenceInputs& in, std::shared_ptr<const DiffuseLight> diffuse) {
  const Frame& f = scene.frames[static_cast<std::size_t>(frame)];
  FrameEvidence evidence;
  if (in.whatIf.synthesise && f.highlights.empty()) {
    evidence.frame = frame;
    evidence.id = f.id;
    evidence.failure = Failure{Reason::NoHighlight, "no light produces one in frame " + f.id};
    return evidence;
  }
  const PhotographsHeld held(scene, {frame});  // some read it twice
  evidence = gatherEvidence(scene, frame, in.source, in.detect, {}, std::move(diffuse));
  const bool detected = !evidence.highlights.empty() && !evidence.highlights.front().fromScene;
  if (detected && in.detect.background == BackgroundUse::Colours) {
    SpecularSeparation separation = separateEvidence(scene, frame, in.source, in.detect, evidence);
    evidence.notSeparated = std::move(separation.reason);
    evidence.separated = std::move(separation.regions);
  }
  if (in.truthFolder.empty()) return evidence;
  evidence.againstTruth = true;
  Outcome<std::vector<Highlight>> truth = readTruth(in.truthFolder, scene, frame, in.detect.level);
  if (truth)
    evidence.truth = std::move(*truth);
  else
    evidence.truthFailure = truth.failure();
  return evidence;
}

bool changesHighlights(const WhatIf& w, int frame) {
  const auto moved = w.highlights.lower_bound({frame, 0});
  return (moved != w.highlights.end() && moved->first.first == frame) || hasEdits(w, frame);
}

void moveHighlights(FrameEvidence& e, const WhatIf& w) {
  for (std::size_t i = 0; i < e.highlights.size(); ++i)
    if (const auto by = w.highlights.find({e.frame, e.asFound(static_cast<int>(i))}); by != w.highlights.end())
      e.highlights[i] = changed(e.highlights[i], by->second);
}

bool showsSwitchedOff(const FrameEvidence& e, const WhatIf& w) {
  const auto off = [&](const Highlight& h) { return isSwitchedOff(w, e.frame, h.light); };
  return std::any_of(e.highlights.begin(), e.highlights.end(), off) || std::any_of(e.truth.begin(), e.truth.end(), off);
}

void dropSwitchedOff(FrameEvidence& e, const WhatIf& w) {
  if (!showsSwitchedOff(e, w)) return;
  std::vector<Highlight> kept;
  std::vector<int> found;
  std::set<std::string> lights;
  for (std::size_t i = 0; i < e.highlights.size(); ++i) {
    Highlight& h = e.highlights[i];
    if (isSwitchedOff(w, e.frame, h.light)) {
      lights.insert(h.light);
      continue;
    }
    found.push_back(e.asFound(static_cast<int>(i)));
    kept.push_back(std::move(h));
  }
  e.highlights = std::move(kept);
  e.found = std::move(found);
  if (e.highlights.empty() && !e.failure) {
    std::string names;
    for (const std::string& light : lights) names += (names.empty() ? "" : ", ") + light;
    e.failure = Failure{Reason::NoHighlight, "switched off: " + names};
  }
  std::erase_if(e.truth, [&](const Highlight& h) { return isSwitchedOff(w, e.frame, h.light); });
}

bool lightsAreOpenIn(const Scene& scene, const InspectionRequest& request) {
  return !request.whatIf.synthesise && lightsNeedAllFrames(scene);
}

}  // namespace glint
