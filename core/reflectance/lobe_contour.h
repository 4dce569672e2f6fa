// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "core/highlight/highlight.h"
#include "core/reflectance/pixel_fit.h"

namespace glint {

/// The highlights of one light in one frame, found again with what a known lobe leaves as background (method.md section 15, "Bias
/// of the detected level"): I = K S + b gives b and K, and contours are taken at q K S_peak of I - b. A background that is fitted
/// to the pixels around a highlight without the lobe takes in the tail of a long-tailed one, so that contours come out 2 % too
/// small (GGX).
///
/// Where the highlight is clipped, its peak is the lobe's. Where the contour at q lies in clipped pixels, the highlight as found
/// is returned, with the level at which it really lies.
/// @param found      of one light, ideal pixels, as detected
/// @param others     of other lights in this frame
/// @param options    as they were detected with (level, smallest area, contrast)
/// @return           the same highlights in the same order, each contoured again. NoBrightestPoint where the lobe does not reach
///                   them; NotConverged where it does not explain the frame; TooFewPoints.
Outcome<std::vector<Highlight>> contourWithLobe(const LinearPixels& pixels, const Camera& camera, const Surface& surface,
                                                int frame, const std::vector<Highlight>& found,
                                                const std::vector<Highlight>& others, const LobeModel& model,
                                                BackgroundKind background, const DetectOptions& options);

}  // namespace glint
