// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "core/retexture/appearance.h"

namespace glint {

/// What a model predicts that the highlights of a frame add to its picture.
struct PredictedRadiance {
  Image radiance;  ///< 3 channels, linear light (1 = the largest code), at the camera's measured pixels
  /// Per pixel: neither prediction nor training pixels reach it: gaps of the contour, clipped cores.
  std::vector<char> extrapolated;
  std::vector<Polyline> contours;  ///< predicted, ideal pixels
  std::vector<double> coverage;    ///< of each contour, share of its directions that were predicted
  struct OfLight {
    std::string light;
    HighlightAppearance appearance;
  };
  std::vector<OfLight> lights;       ///< those that are in `radiance`
  std::vector<std::string> remarks;  ///< what makes it doubtful, and which lights are missing, for the user
};

/// @param model  one that the inspection computed. @param light  id; "" = every light that was predicted in this frame.
/// @param known  what was learned before; null = learns anew.
/// The prediction's failure where the model predicts no highlight of these lights in the frame; learnAppearance()'s; NotSupported
/// where no such light was looked at; NoSurface. std::invalid_argument for a frame or model that does not exist. Stopped.
Outcome<PredictedRadiance> predictedRadiance(const Inspection& inspection, int frame, const std::string& model,
                                             const std::string& light = "", const ProgressFn& progress = {},
                                             LearnedAppearances* known = nullptr);

}  // namespace glint
