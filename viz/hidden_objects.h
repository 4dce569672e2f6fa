// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <set>
#include <string>
#include <utility>

namespace glint::viz {

/// Things of the scene that the 3D picture leaves out, each with what belongs to it; layers say which kinds of things are drawn
/// at all. What is hidden stays in every computation.
struct HiddenObjects {
  std::set<int> frames;  ///< indices: the camera, its photograph and virtual cameras, all that is observed and predicted in it
  std::set<std::string> surfaces;  ///< keys of SurfaceCache::keyOf(); kDepthMaps stands for the depth maps of all frames
  std::set<std::string> lights;    ///< ids: estimate and truth
  /// Model and light: Q*, its cones, the light and the contours that the model predicts.
  std::set<std::pair<std::string, std::string>> ellipsoids;

  static constexpr const char* kDepthMaps = "depth:";
  bool hidesSurface(const std::string& key) const {
    return surfaces.count(key.rfind(kDepthMaps, 0) == 0 ? std::string(kDepthMaps) : key) > 0;
  }
  std::size_t count() const { return frames.size() + surfaces.size() + lights.size() + ellipsoids.size(); }
  friend bool operator==(const HiddenObjects&, const HiddenObjects&) = default;
};

}  // namespace glint::viz
