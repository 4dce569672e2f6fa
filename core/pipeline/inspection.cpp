// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/inspection.h"

#include <algorithm>
#include <utility>

#include "core/pipeline/carried.h"
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

Eigen::Isometry3d Inspection::lightFromScene(int frame, const std::string& light) const {
  if (inScene || !lightFrame.elsewhere.count(light)) return Eigen::Isometry3d::Identity();
  const Eigen::Isometry3d& camFromWorld = world->frames[static_cast<std::size_t>(frame)].camera.camFromWorld;
  return lightFrame.frame == LightFrame::World ? camFromWorld : camFromWorld.inverse();
}

Camera Inspection::cameraFor(int frame, const std::string& light) const {
  return carried(scene->frames[static_cast<std::size_t>(frame)].camera, lightFromScene(frame, light));
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

namespace {
Outcome<std::shared_ptr<const Surface>> surfaceInScene(const Inspection& inspection, int frame, const std::string& light) {
  const MeshPolicy policy = meshPolicy(inspection.request.settings);
  const FitKey key = inspection.keyFor(frame, light);
  const auto found = inspection.corrections.find(key);
  if (found == inspection.corrections.end()) return inspection.surfaces->surfaceOf(frame, policy);
  const Frame& f = inspection.scene->frames[static_cast<std::size_t>(frame)];
  if (found->second.depth && f.surface.empty() && inspection.correctedDepthMaps)
    return inspection.correctedDepthMaps->surfaceOf(f, policy, key, *found->second.depth);
  return correctedSurface(*inspection.scene, *inspection.surfaces, frame, found->second, policy);
}
}  // namespace

Outcome<std::shared_ptr<const Surface>> surfaceFor(const Inspection& inspection, int frame, const std::string& light) {
  if (!inspection.surfaces) return Failure{Reason::NoSurface, ""};
  Outcome<std::shared_ptr<const Surface>> found = surfaceInScene(inspection, frame, light);
  if (!found) return found;
  return carried(*std::move(found), inspection.lightFromScene(frame, light));
}

TrainingView trainingViewIn(const Inspection& inspection, const FrameEvidence& evidence, int highlight,
                            std::shared_ptr<const Surface> surface, CutUse cut) {
  const Camera& camera = inspection.scene->frames[static_cast<std::size_t>(evidence.frame)].camera;
  const TrainingView view = trainingView(evidence, highlight, camera, std::move(surface), cut);
  TrainingView there = carried(view, inspection.lightFromScene(evidence.frame, view.highlight.light));
  there.known = knownLamp(*inspection.scene, view.highlight.light);
  return there;
}

std::shared_ptr<const Inspection> inSceneAt(std::shared_ptr<const Inspection> inspection, int frame) {
  if (!inspection || inspection->inScene || inspection->lightFrame.elsewhere.empty()) return inspection;
  auto there = std::make_shared<Inspection>(*inspection);
  frame = std::max(frame, 0);  // where none is chosen, lights are where the first one has them
  const auto back = [&](int at, const std::string& light) { return inspection->lightFromScene(at, light).inverse(); };
  there->inScene = true;
  for (TrainingView& v : there->views) v = carried(v, back(v.frame, v.highlight.light));
  for (auto& [index, v] : there->viewsAsGiven) v = carried(v, back(v.frame, v.highlight.light));
  for (auto& [key, light] : there->lights)
    if (light && inspection->lightFrame.elsewhere.count(key.light)) light = carried(*std::move(light), back(frame, key.light));
  for (auto& [name, result] : there->models) {
    for (FrameComparison& c : result.frames) carry(c.prediction, back(c.frame, c.light));
    for (ModelResult::Fit& fit : result.fits)
      if (fit.fit && inspection->lightFrame.elsewhere.count(fit.light))
        fit.fit = carried(*std::move(fit.fit), back(frame, fit.light));
  }
  return there;
}

std::shared_ptr<const Inspection> inSceneAt(const Inspection& inspection, int frame) {
  return inSceneAt(std::shared_ptr<const Inspection>(std::shared_ptr<const Inspection>(), &inspection), frame);
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
