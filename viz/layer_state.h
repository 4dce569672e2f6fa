// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <string>

#include "core/base/outcome.h"
#include "viz/layers.h"

namespace glint::viz {

/// A layer of one picture, as far as it is built.
struct LayerState {
  LayerContent content;
  unsigned stale = ~0u;  ///< changes since the last build: at first everything
  bool visible = true;
  bool built = false;
  int builds = 0;
};

/// Place in sceneLayers(). std::invalid_argument for an unknown name.
inline std::size_t layerIndex(const std::string& name) {
  const std::vector<Layer>& layers = sceneLayers();
  const auto found = std::find_if(layers.begin(), layers.end(), [&](const Layer& layer) { return layer.name == name; });
  require(found != layers.end(), "SceneView: no layer named \"" + name + "\"");
  return static_cast<std::size_t>(found - layers.begin());
}

}  // namespace glint::viz
