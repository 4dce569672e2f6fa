// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/surface_correction.h"

#include "core/pipeline/corrected_depth.h"
#include "core/surface/posed_surface.h"

namespace glint {

Outcome<std::shared_ptr<const Surface>> correctedSurface(const Scene& scene, const SurfaceCache& surfaces, int frame,
                                                         const SurfaceCorrection& correction, MeshPolicy policy) {
  const Frame& f = scene.frames[static_cast<std::size_t>(frame)];
  const std::string key = surfaces.keyOf(frame);
  if (correction.normals && correction.normals->surface == key) return movedTo(f.worldFromObject, correction.normals->mesh);
  if (correction.smoothed && correction.smoothed->surface == key) return movedTo(f.worldFromObject, correction.smoothed->mesh);
  if (correction.depth && f.surface.empty()) return correctedDepthMap(f, policy, *correction.depth);
  return surfaces.surfaceOf(frame, policy);
}

void correctViews(std::vector<TrainingView>& views, const Scene& scene, const SurfaceCache& surfaces,
                  const SurfaceCorrection& correction, MeshPolicy policy) {
  if (!correction) return;
  for (TrainingView& v : views) {
    if (!v.seen) continue;
    const Outcome<std::shared_ptr<const Surface>> surface = correctedSurface(scene, surfaces, v.frame, correction, policy);
    v = onSurface(v, surface ? *surface : nullptr);
  }
}

}  // namespace glint
