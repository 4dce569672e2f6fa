// SPDX-License-Identifier: BSD-3-Clause
#include "viz/layers.h"

namespace glint::viz {

const std::vector<LayerRecipe>& layerRecipes() {
  constexpr unsigned kPlace = kOnInspection | kOnSurface;  // everything that lies in the scene
  static const std::vector<LayerRecipe> recipes{
      {{"surface", "Surface", true}, kOnSurface, surfaceLayer},
      {{"cameras", "Cameras", true}, kPlace | kOnFrame | kOnModels | kOnGlyphs | kOnTheme, camerasLayer},
      {{"photographs", "Photographs", true}, kOnSurface | kOnFrame | kOnGlyphs, photographsLayer},
      {{"virtual-cameras", "Virtual cameras", true}, kPlace | kOnFrame | kOnGlyphs, virtualCamerasLayer},
      {{"peaks", "Brightest points", true}, kPlace | kOnFrame | kOnModels | kOnGlyphs, peaksLayer},
      {{"tangent-planes", "Tangent planes", true}, kPlace | kOnFrame | kOnModels, tangentPlanesLayer},
      {{"canonical-ellipses", "Canonical ellipses", true}, kPlace | kOnFrame | kOnModels, canonicalEllipsesLayer},
      {{"directions", "Limit-angle directions", false}, kPlace | kOnFrame | kOnModels | kOnGlyphs | kOnTheme, directionsLayer},
      {{"ellipsoids", "Ellipsoids", true}, kPlace | kOnModels, ellipsoidsLayer},
      {{"light", "Light (estimate)", true}, kPlace | kOnModels | kOnGlyphs, lightLayer},
      {{"true-light", "Light (truth)", true}, kOnSurface | kOnGlyphs, trueLightLayer},
      {{"rays", "Reflected rays", false}, kPlace | kOnFrame, raysLayer},
      {{"observed-contours", "Observed contours", true}, kPlace | kOnFrame | kOnHighlight, observedContoursLayer},
      {{"predicted-contours", "Predicted contours", true}, kPlace | kOnFrame | kOnModels, predictedContoursLayer},
  };
  return recipes;
}

const std::vector<Layer>& sceneLayers() {
  static const std::vector<Layer> layers = [] {
    std::vector<Layer> result;
    for (const LayerRecipe& recipe : layerRecipes()) result.push_back(recipe.layer);
    return result;
  }();
  return layers;
}

}  // namespace glint::viz
