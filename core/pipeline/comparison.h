// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/pipeline/inspection.h"

namespace glint {

/// Matches a prediction with the frame's scored highlights of one light by overlap and measures each pair (method.md
/// section 10); what has no partner becomes a row of its own. Predictions are clipped to the image when the observed
/// contour was cut by its border.
FrameComparison compareFrame(const FrameEvidence& evidence, const std::string& light, const Camera& camera, Prediction prediction);

}  // namespace glint
