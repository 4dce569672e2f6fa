// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "core/pipeline/inspection.h"
#include "core/reflectance/pixel_fit.h"

namespace glint {

/// Where no response of the camera is stated and codes were read through the sRGB curve: whether the pixels of a light's
/// highlights say that this was wrong. Up to three views are fitted again as linear codes and as powers of 1.8 and 2.2; one of
/// them is named if it leaves less than two thirds of the residual. Asked only where the residuals of neighbouring pixels go
/// together, as a wrong curve makes them. A highlight of a Gaussian lobe on black tells nothing: any power of it is another
/// such lobe.
/// @param views  with their pixels, of one light. @param fit  to them
/// @return  a sentence with what to state; "" where there is nothing to say. Throws Stopped.
std::string responseDoubt(const Scene& scene, FrameSource source, const std::vector<TrainingView>& views, const PixelFit& fit,
                          const ProgressFn& progress);

}  // namespace glint
