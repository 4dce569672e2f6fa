// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/geometry/light.h"
#include "core/pipeline/sighting_fit.h"

namespace glint {

/// A wide lobe under the highlights (a coat over a rough base): what looks like shading around a highlight, but goes along with
/// it. Contours and fits take it for a background, and are off by it.
struct SecondLobe {
  double share = 0, sigma = 0;  ///< its peak, as a share of the highlight's
  double timesWider = 0;        ///< its half angle at half of its peak, over that of the highlight
};

/// From the light of the same surface points in several views, three radii and more from highlights (method.md section 17,
/// "Coat"): what depends on the half angle there, and is neither the highlight's own tail (Gaussian, GGX) nor alike in all views.
/// @param points  brightSightings() of the panel, the same again
/// @param light   in the coordinates of the panel. @param halfAngle  that the contours at half of the peak reach, rad
/// @return  nothing below a fiftieth of the peak, where the views do not tell, or where it explains little of what changes
std::optional<SecondLobe> secondLobeOf(const TexturePanel& panel, const std::vector<PointSamples>& points, const Light& light,
                                       double halfAngle);

/// A sentence about it; "" for nothing.
std::string secondLobeRemark(const std::optional<SecondLobe>& found);

}  // namespace glint
