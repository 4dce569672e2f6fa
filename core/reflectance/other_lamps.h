// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "core/geometry/camera.h"
#include "core/reflectance/pixel_fit.h"
#include "core/surface/surface.h"

namespace glint {

/// One lamp in a frame where several are on: the pixels around its highlights, and the lobe that a fit found for it.
struct LampPatches {
  std::vector<const PixelPatch*> patches;
  LobeModel model;
  BackgroundKind background = BackgroundKind::None;
};

/// What a photograph shows is the sum of all lamps, and long-tailed lobes reach into each other's highlights (method.md section
/// 7, "Several lamps in a frame"). The strengths of the lamps in this frame are found in turn, each with the light of the others
/// taken off.
/// @return  for each lamp the light of the others; empty where it does not show in the lamp's pixels, by 3 in 10,000 of their top
std::vector<std::vector<LampLight>> lightOfOthers(const std::vector<LampPatches>& lamps, const Surface& surface,
                                                  const Camera& camera);

/// What these lamps add to every cell of a patch; 0 off the surface.
std::vector<double> lightOn(const PixelPatch& patch, const std::vector<LampLight>& lamps, const Surface& surface,
                            const Camera& camera);

/// The patch without such light.
PixelPatch withoutLight(PixelPatch patch, const std::vector<double>& light);

}  // namespace glint
