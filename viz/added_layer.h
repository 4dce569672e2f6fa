// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "viz/layers.h"

namespace glint::viz {

/// Takes the layers that a plugin adds (core/app/plugin.h, GLINT_PLUGIN_WITH_LAYERS).
class LayerRegistry {
 public:
  virtual ~LayerRegistry() = default;
  /// std::invalid_argument for a name that is taken or empty, or without a function.
  virtual void add(const LayerRecipe& recipe) = 0;
};

/// Adds the layers of the plugins that are loaded, behind the others. Call it once, before anything asks for sceneLayers().
/// @return one line for each plugin whose layers were refused.
std::vector<std::string> addPluginLayers();

}  // namespace glint::viz
