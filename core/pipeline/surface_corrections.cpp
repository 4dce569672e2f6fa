// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/surface_corrections.h"

#include <algorithm>

#include "core/pipeline/training.h"
#include "core/surface/mesh_policy.h"

namespace glint {

std::vector<TrainingView> SurfaceCorrections::of(const std::vector<int>& views) const {
  std::vector<TrainingView> result;
  for (const int v : views) result.push_back(r_.views[v]);
  return result;
}

std::shared_ptr<const Surface> SurfaceCorrections::surfaceOf(int frame, const FitKey& key) {
  const MeshPolicy policy = meshPolicy(r_.request.settings);
  if (const auto refined = r_.refinedNormals.find(key); refined != r_.refinedNormals.end() && refined->second.surface == r_.surfaces->keyOf(frame))
    return refined->second.mesh;
  const Frame& f = r_.scene->frames[frame];
  const auto depth = r_.depthCorrections.find(key);
  const Outcome<std::shared_ptr<const Surface>> s = depth != r_.depthCorrections.end() && f.surface.empty()
                                                        ? depthMaps_.surfaceOf(f, policy, key, depth->second)
                                                        : r_.surfaces->surfaceOf(frame, policy);
  return s ? *s : nullptr;
}

void SurfaceCorrections::refine(const std::vector<int>& views, const FitKey& key, LightEstimate& light) {
  if (r_.request.settings.flag("light.refine_depth")) refineDepth(views, key, light);
  if (r_.request.settings.flag("light.refine_normals")) refineNormals(views, key, light);
}

void SurfaceCorrections::refineDepth(const std::vector<int>& views, const FitKey& key, LightEstimate& light) {
  for (const int v : views)
    if (!r_.scene->frames[r_.views[v].frame].surface.empty()) return;  // a mesh or a shape has no depth that could be off
  const Outcome<DepthRefinement> refined = glint::refineDepth(of(views), light.light, r_.request.settings);
  if (!refined || !refined->correction.changesAnything()) return;
  r_.depthCorrections.insert_or_assign(key, refined->correction);
  const std::vector<TrainingView> before = r_.views;
  correctViews(views, key);
  const Outcome<LightEstimate> again = estimateLight(of(views), r_.request.settings);
  if (!again || !(again->rmsPx < light.rmsPx)) {  // the corrected surfaces do not keep what the correction promised
    r_.views = before;
    r_.depthCorrections.erase(key);
    return;
  }
  light = *again;
  if (!light.extent && refined->uncertainty) light.uncertainty = refined->uncertainty;
}

void SurfaceCorrections::refineNormals(const std::vector<int>& views, const FitKey& key, LightEstimate& light) {
  if (views.empty()) return;
  const std::string surface = r_.surfaces->keyOf(r_.views[views.front()].frame);
  const auto source = r_.scene->surfaces.find(surface);
  if (source == r_.scene->surfaces.end() || !source->second.mesh) return;  // a shape is exact, a depth map has a depth that could be off
  // What one mesh has wrong another one has not.
  if (std::any_of(views.begin(), views.end(), [&](int v) { return r_.surfaces->keyOf(r_.views[v].frame) != surface; })) return;
  Outcome<std::optional<RefinedNormals>> refined = glint::refineNormals(of(views), light, surface, r_.request.settings);
  if (!refined || !*refined) return;
  const std::optional<ParameterUncertainty> uncertainty = (*refined)->uncertainty;
  r_.refinedNormals.insert_or_assign(key, **std::move(refined));
  correctViews(views, key);
  if (const Outcome<LightEstimate> again = estimateLight(of(views), r_.request.settings)) light = *again;
  if (!light.extent && uncertainty) light.uncertainty = uncertainty;
}

void SurfaceCorrections::correctViews(const std::vector<int>& views, const FitKey& key) {
  if (const auto refined = r_.refinedNormals.find(key); refined != r_.refinedNormals.end()) {
    for (const int v : views)
      if (!r_.views[v].failure) r_.views[v] = onSurface(r_.views[v], refined->second.mesh);
    return;
  }
  if (!r_.depthCorrections.count(key)) return;
  for (const int v : views) {
    TrainingView& view = r_.views[v];
    FrameEvidence evidence;
    evidence.frame = view.frame;
    evidence.highlights = {view.highlight};
    view = trainingView(evidence, 0, view.camera, surfaceOf(view.frame, key));
  }
}

}  // namespace glint
