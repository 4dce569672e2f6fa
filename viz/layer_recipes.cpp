// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "core/app/load_plugins.h"
#include "viz/added_layer.h"
#include "viz/layers.h"

namespace glint::viz {

namespace {

std::vector<LayerRecipe>& registered() {
  constexpr unsigned kPlace = kOnInspection | kOnSurface | kOnHidden;  // everything that lies in the scene
  static std::vector<LayerRecipe> recipes{
      {{"surface", "Surface", true}, kOnSurface | kOnHidden, surfaceLayer},
      {{"cameras", "Cameras", true},
       kPlace | kOnFrame | kOnModels | kOnGlyphs | kOnTheme | kOnEye | kOnColours | kOnSolo,
       camerasLayer},
      {{"photographs", "Photographs", true},
       kOnScene | kOnSurface | kOnFrame | kOnGlyphs | kOnEye | kOnPhotographs | kOnSolo | kOnHidden,
       photographsLayer},
      {{"virtual-cameras", "Virtual cameras", true}, kPlace | kOnFrame | kOnGlyphs | kOnEye | kOnSolo, virtualCamerasLayer},
      {{"peaks", "Brightest points", true}, kPlace | kOnFrame | kOnModels | kOnGlyphs | kOnSolo | kOnTheme, peaksLayer},
      {{"tangent-planes", "Tangent planes", true}, kPlace | kOnFrame | kOnModels | kOnPicked | kOnSolo, tangentPlanesLayer},
      {{"canonical-ellipses", "Canonical ellipses", true},
       kPlace | kOnFrame | kOnModels | kOnEye | kOnSolo,
       canonicalEllipsesLayer},
      {{"directions", "Limit-angle directions", false}, kPlace | kOnFrame | kOnModels | kOnGlyphs | kOnTheme, directionsLayer},
      {{"walk", "Walk of one direction", false}, kPlace | kOnFrame | kOnTheme | kOnWalk, walkLayer},
      {{"cones", "Cones to the ellipsoid", false}, kPlace | kOnFrame | kOnModels | kOnPicked | kOnSolo, conesLayer},
      {{"ellipsoids", "Ellipsoids", true}, kPlace | kOnModels | kOnPicked | kOnTheme, ellipsoidsLayer},
      {{"light", "Light (estimate)", true}, kPlace | kOnModels | kOnGlyphs | kOnPicked | kOnTheme, lightLayer},
      {{"true-light", "Light (truth)", true}, kOnScene | kOnSurface | kOnGlyphs | kOnHidden, trueLightLayer},
      {{"measured-lamps", "Measured lamps", true}, kOnSurface | kOnGlyphs | kOnPicked | kOnHidden | kOnLamps, measuredLampsLayer},
      {{"solver-runs", "Runs of solvers", true},
       kOnSurface | kOnModels | kOnGlyphs | kOnPicked | kOnTheme | kOnHidden | kOnRuns,
       solverRunsLayer},
      {{"rays", "Reflected rays", false}, kPlace | kOnFrame | kOnSolo | kOnGlyphs | kOnTheme, raysLayer},
      {{"observed-contours", "Observed contours", true},
       kPlace | kOnFrame | kOnModels | kOnHighlight | kOnPicked | kOnGlyphs | kOnTheme | kOnSolo,
       observedContoursLayer},
      {{"predicted-contours", "Predicted contours", true},
       kPlace | kOnFrame | kOnModels | kOnHighlight | kOnPicked | kOnGlyphs | kOnTheme,
       predictedContoursLayer},
  };
  return recipes;
}

/// Keeps the layers of one plugin until all of them have been checked.
class Staged final : public LayerRegistry {
 public:
  void add(const LayerRecipe& recipe) override {
    const std::string& name = recipe.layer.name;
    require(recipe.build != nullptr, "layer '" + name + "': it has no function");
    for (const auto* list : {&registered(), &recipes})
      for (const LayerRecipe& other : *list)
        require(!name.empty() && other.layer.name != name, "layer '" + name + "': the name is taken or empty");
    recipes.push_back(recipe);
  }
  std::vector<LayerRecipe> recipes;
};

}  // namespace

std::vector<std::string> addPluginLayers() {
  std::vector<std::string> refused;
  for (const LoadedPlugin& plugin : loadedPlugins()) {
    if (!plugin.declaration->addLayers) continue;
    Staged staged;
    try {
      plugin.declaration->addLayers(staged);
      registered().insert(registered().end(), staged.recipes.begin(), staged.recipes.end());
    } catch (const std::exception& e) {
      refused.push_back("layers of plugin '" + plugin.name + "' not added: " + e.what());
    }
  }
  return refused;
}

const std::vector<LayerRecipe>& layerRecipes() { return registered(); }

const std::vector<Layer>& sceneLayers() {
  // The pages of a command line ask before its plugins are loaded, too; nothing is added after a program's start.
  static std::vector<Layer> layers;
  const std::vector<LayerRecipe>& recipes = layerRecipes();
  for (std::size_t i = layers.size(); i < recipes.size(); ++i) layers.push_back(recipes[i].layer);
  return layers;
}

}  // namespace glint::viz
