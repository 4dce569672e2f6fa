// SPDX-License-Identifier: BSD-3-Clause
#include "viz/layers.h"

namespace glint::viz {

const std::vector<LayerRecipe>& layerRecipes() {
  constexpr unsigned kPlace = kOnInspection | kOnSurface | kOnHidden;  // everything that lies in the scene
  static const std::vector<LayerRecipe> recipes{
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
      {{"rays", "Reflected rays", false}, kPlace | kOnFrame | kOnSolo | kOnGlyphs | kOnTheme, raysLayer},
      {{"observed-contours", "Observed contours", true},
       kPlace | kOnFrame | kOnHighlight | kOnPicked | kOnGlyphs | kOnTheme | kOnSolo,
       observedContoursLayer},
      {{"predicted-contours", "Predicted contours", true},
       kPlace | kOnFrame | kOnModels | kOnHighlight | kOnPicked | kOnGlyphs | kOnTheme,
       predictedContoursLayer},
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
