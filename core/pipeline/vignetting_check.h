// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/pipeline/sighting_fit.h"
#include "core/scene/camera_response.h"

namespace glint {

/// How much less light the corners of images get than their middle.
struct Vignetting {
  double cornerLoss = 0;  ///< share; the loss grows with the square of the distance from the middle
  double sigma = 0;
};

/// From the diffuse light of the same surface points in several views, away from highlights: v_ij = g_i D_j (1 - k r_ij^2) +
/// tails,
/// with a gain for each view, D eliminated, and the spots' tails as two more shares. It is believed only if the light falls alike
/// across and along the image and has no slope: what changes with the view otherwise (a lamp that moves, long tails) does not.
/// @param points  brightSightings() of the panel
/// @return  nothing where the light does not fall by a seventh, or the views do not tell
std::optional<Vignetting> vignettingOf(const TexturePanel& panel, const std::vector<PointSamples>& points);

/// A sentence about it, with what undoes it; "" for nothing.
/// @param response  of the views' images
std::string vignettingRemark(const std::optional<Vignetting>& found, std::size_t views, const CameraResponse& response);

}  // namespace glint
