// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/pipeline/lobe_stage.h"
#include "core/pipeline/sighting_fit.h"

namespace glint {

/// Points of one surface as some of its training frames show them beside their highlights.
struct SightedSurface {
  std::vector<int> frames;  ///< all training frames that show it
  TexturePanel panel;
  std::vector<PointSamples> points;  ///< brightSightings()
  bool photographs = false;          ///< the values come from codes, not from radiance
};

/// Adds to Inspection::pixelDoubts; "" adds nothing.
void addDoubt(Inspection& inspection, const FitKey& key, const std::string& doubt);

/// One for each surface that at least four training frames show under the same lamps. An object that moves is sighted around
/// itself: panels and points are in its own coordinates.
std::vector<SightedSurface> sightedSurfaces(const Inspection& inspection, const std::vector<int>& frames,
                                            const SurfaceOfFrame& surfaceOf);

/// Light that falls towards the corners of photographs goes to Inspection::pixelDoubts.
void addVignetting(Inspection& inspection, const std::vector<SightedSurface>& sighted);

/// A wide second lobe under the highlights does, too, where one lamp stands still beside a still object and its pixels have a
/// fit. @param views  by light and surface, what was fitted
void addSecondLobes(Inspection& inspection, const std::vector<SightedSurface>& sighted,
                    const std::map<FitKey, std::vector<TrainingView>>& views);

}  // namespace glint
