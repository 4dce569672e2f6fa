// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/base/settings.h"
#include "core/geometry/camera.h"
#include "core/model/model.h"
#include "core/surface/surface.h"

namespace glint {

/// Moves what the settings exclude from a prediction to Prediction::filtered, each with its reason; if nothing is left, the
/// first reason is the answer (NoHighlight).
///   predict.filter_area        smaller than detection takes: detect.min_area, px^2. Counts the contour beyond the image, too
///   predict.filter_brightness  fainter than this share of the brightest one of the same prediction. I falls with the angle alpha
///                              between normal and half vector at the brightest point as a Gaussian lobe does,
///                              log I = log(q) (tan alpha / tan alpha_lim)^2 with the level q (method.md section 5), or by the
///                              lobe of `reflectance`
///   predict.filter_shadow      the surface itself hides the light from the middle of the contour
/// The last two need the fit's light and, of brightness, its limit angle or lobe; models without them keep everything.
/// @param surface  may be null
void filterPrediction(Prediction& prediction, const ModelFit& fit, const Camera& camera, const Surface* surface,
                      const Settings& settings);

}  // namespace glint
