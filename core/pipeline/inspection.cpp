// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/inspection.h"

#include <algorithm>
#include <utility>

#include "core/pipeline/corrected_depth.h"
#include "core/pipeline/known_lamps.h"
#include "core/scene/frame_name.h"
#include "core/surface/mesh_policy.h"

namespace glint {

TrainSpec parseTrainSpec(const std::string& text, const Scene& scene) {
  TrainSpec spec;
  spec.text = text;
  if (text == "per-surface") {
    spec.perSurface = true;
    for (int i = 0; i < static_cast<int>(scene.frames.size()); ++i) spec.frames.push_back(i);
    return spec;
  }
  spec.frames = parseFrames(text, scene, "--train");
  return spec;
}

std::string trainText(const TrainSpec& train, const Scene& scene) {
  if (train.perSurface) return train.text;
  const bool rule = train.text.find(':') != std::string::npos && parseFrames(train.text, scene, "--train") == train.frames &&
                    (train.text.rfind("first:", 0) == 0 || train.text.rfind("spread:", 0) == 0);
  return (rule ? train.text + ", " : "") + frameSpec(train.frames, scene);
}

TrainingView Inspection::viewAsGiven(int view) const {
  const auto given = viewsAsGiven.find(view);
  TrainingView v = given != viewsAsGiven.end() ? given->second : views[static_cast<std::size_t>(view)];
  v.canonical.reset();
  return v;
}

std::vector<TrainingView> Inspection::viewsOf(const FitKey& key, bool asGiven) const {
  const std::optional<KnownLamp> lamp = knownLamp(*scene, key.light);
  std::vector<TrainingView> own;
  for (std::size_t i = 0; i < views.size(); ++i) {
    const std::string& light = views[i].highlight.light;
    const FitKey serves = keyFor(views[i].frame, light);
    if (lamp ? serves.surface != key.surface || !views[i].known : serves != key) continue;
    own.push_back(asGiven ? viewAsGiven(static_cast<int>(i)) : views[i]);
  }
  return lamp ? pooledViews(own, *lamp) : own;
}

const FrameEvidence* Inspection::evidenceOf(int frame, const StageInputs& from) const {
  if (!inputs.same(Stage::Evidence, from)) return nullptr;
  const FrameEvidence& e = evidence[static_cast<std::size_t>(frame)];
  return e.frame >= 0 ? &e : nullptr;
}

Inspection Inspection::evidenceAlone() && {
  Inspection alone = std::move(*this);
  alone.inputs = alone.inputs.upToLobes();
  alone.views.clear();
  alone.viewsAsGiven.clear();
  alone.lights.clear();
  alone.corrections.clear();
  alone.models.clear();
  return alone;
}

FitKey Inspection::keyFor(int frame, const std::string& light) const {
  return {light, train.perSurface && surfaces ? std::optional(surfaces->keyOf(frame)) : std::nullopt};
}

const LightEstimate* Inspection::lightOf(const FitKey& key) const {
  const auto found = lights.find(key);
  return found != lights.end() && found->second ? &*found->second : nullptr;
}

const SurfaceCorrection* Inspection::chosenFor(const FitKey& key) const {
  static const SurfaceCorrection none;
  if (!lights.count(key)) return nullptr;
  const auto found = corrections.find(key);
  return found != corrections.end() ? &found->second : &none;
}

const Failure* Inspection::lightFailureFor(int frame, const std::string& light) const {
  const auto found = lights.find(keyFor(frame, light));
  return found != lights.end() && !found->second ? &found->second.failure() : nullptr;
}

Outcome<std::shared_ptr<const Surface>> surfaceFor(const Inspection& inspection, int frame, const std::string& light) {
  if (!inspection.surfaces) return Failure{Reason::NoSurface, ""};
  const MeshPolicy policy = meshPolicy(inspection.request.settings);
  const FitKey key = inspection.keyFor(frame, light);
  const auto found = inspection.corrections.find(key);
  if (found == inspection.corrections.end()) return inspection.surfaces->surfaceOf(frame, policy);
  const Frame& f = inspection.scene->frames[static_cast<std::size_t>(frame)];
  if (found->second.depth && f.surface.empty() && inspection.correctedDepthMaps)
    return inspection.correctedDepthMaps->surfaceOf(f, policy, key, *found->second.depth);
  return correctedSurface(*inspection.scene, *inspection.surfaces, frame, found->second, policy);
}

std::vector<std::pair<std::string, const Outcome<LightEstimate>*>> Inspection::lightsFor(int frame) const {
  std::vector<std::pair<std::string, const Outcome<LightEstimate>*>> found;
  for (const auto& [key, light] : lights)
    if (key == keyFor(frame, key.light)) found.emplace_back(key.light, &light);
  return found;
}

bool Inspection::isTraining(int frame) const {
  return std::binary_search(train.frames.begin(), train.frames.end(), frame) &&
         std::find(request.excluded.begin(), request.excluded.end(), frame) == request.excluded.end();
}

bool Inspection::isHeldOut(int frame) const {
  if (std::find(request.excluded.begin(), request.excluded.end(), frame) != request.excluded.end()) return false;
  return train.perSurface || !std::binary_search(train.frames.begin(), train.frames.end(), frame);
}

}  // namespace glint
