// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/corrected_depth.h"

#include "core/surface/depth_map.h"

namespace glint {

Outcome<std::shared_ptr<const Surface>> correctedDepthMap(const Frame& frame, MeshPolicy policy,
                                                          const DepthCorrection& correction) {
  if (!frame.surface.empty()) return Failure{Reason::NoSurface, "frame " + frame.id + " does not see its own depth"};
  Outcome<std::optional<Image>> depth = readDepth(frame, policy.depth);
  if (!depth) return depth.failure();
  if (!*depth) return Failure{Reason::NoSurface, "frame " + frame.id + " has neither a surface nor depth"};
  Image& image = **depth;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const Pixel ideal = frame.camera.hasDistortion() ? frame.camera.undistorted(Pixel(x, y)) : Pixel(x, y);
      if (ideal.allFinite()) image.at(x, y) = static_cast<float>(image.at(x, y) * correction.factorAt(frame.camera, ideal));
    }
  DepthMapOptions options;
  options.mesh = policy;
  return makeDepthMap(image, frame.camera, options);
}

Outcome<std::shared_ptr<const Surface>> CorrectedDepthMaps::surfaceOf(const Frame& frame, MeshPolicy policy, const FitKey& key,
                                                                      const DepthCorrection& correction) {
  const std::pair name(key, frame.id);
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    for (auto i = recent_.begin(); i != recent_.end(); ++i)
      if (i->first == name) {
        recent_.splice(recent_.begin(), recent_, i);
        return recent_.front().second;
      }
  }
  const Outcome<std::shared_ptr<const Surface>> made = correctedDepthMap(frame, policy, correction);
  if (!made) return made;
  const std::lock_guard<std::mutex> lock(mutex_);
  recent_.emplace_front(name, *made);
  if (recent_.size() > kKept) recent_.pop_back();
  return made;
}

}  // namespace glint
