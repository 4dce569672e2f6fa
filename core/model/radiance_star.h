// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "core/model/model.h"
#include "core/reflectance/radiance_field.h"

namespace glint {

/// The contours of a reflectance fit and its light by one walk per direction around the maxima beside the mirror points: those of
/// predictLevelSet, to 0.01 % of the diameter, at a twentieth of its time. Where that is not certain, the reason: that of
/// summitNear or starHighlights, or NoBrightestPoint where the brightest maximum lies `faintest` or more (in log I) down the
/// lobe.
Outcome<std::vector<PredictedHighlight>> radianceStars(const RadianceField& radiance, const ReflectanceFit& fit,
                                                       const Light& light, const std::vector<BrightestPoint>& mirrorPoints,
                                                       double faintest, const Camera& camera, const Surface& surface,
                                                       const Settings& settings);

}  // namespace glint
