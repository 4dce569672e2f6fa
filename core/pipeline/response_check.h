// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "core/pipeline/inspection.h"
#include "core/reflectance/pixel_fit.h"

namespace glint {

/// Whether what a fit leaves may be a wrong curve: the residuals of neighbouring pixels go together.
bool asksForResponse(const PixelFit& fit);

/// Where no response of the camera is stated and codes were read through the sRGB curve: whether the pixels of a light's
/// highlights say that this was wrong. Up to three views are fitted again through the sRGB curve, as linear codes, as powers of
/// 1.8
/// and 2.2, and through S-curves, whose contrast is then sought. The one that explains the codes best is named if it leaves
/// clearly
/// less of them: codes are compared, each with the variance that codes like it have, because light would weigh each curve
/// otherwise. A highlight of a Gaussian lobe on black tells no power from another: each is such a lobe.
/// @param views  with their pixels, of one light. @param start  of the fits
/// @return  a sentence with what to state; "" where there is nothing to say. Throws Stopped.
std::string responseDoubt(const Scene& scene, FrameSource source, const std::vector<TrainingView>& views, const LobeModel& start,
                          const ProgressFn& progress);

}  // namespace glint
