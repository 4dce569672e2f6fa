// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/settings.h"
#include "core/model/model.h"
#include "core/reflectance/pixel_patch.h"

namespace glint {

/// How many maxima a patch has inside a contour, each with a valley of at least a fifth of what the peak is above the contour
/// between it and every higher one. Values are smoothed over three by three cells; 0 where nothing inside is used.
int peaksInside(const PixelPatch& patch, const Polyline& contour);

/// Several lamps whose highlights merge into one contour.
struct MergedPeaks {
  std::string text;      ///< how many peaks in how many frames, and what to do
  bool certain = false;  ///< at least two more peaks than one lamp makes: no answer for one lamp describes them
};
/// Where most of the views show more peaks inside of their contour than one lamp has mirror points there. Clipped highlights and
/// those without pixels are not asked.
/// @param light  of these views, if one was found; without one a lamp is taken to have one mirror point
std::optional<MergedPeaks> mergedPeaks(const std::vector<TrainingView>& views, const std::optional<Light>& light,
                                       const Settings& settings);

}  // namespace glint
