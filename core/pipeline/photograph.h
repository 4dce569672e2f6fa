// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "core/base/image.h"
#include "core/base/outcome.h"
#include "core/base/progress.h"
#include "core/pipeline/inspection.h"

namespace glint {

/// What the peak of the brightest highlight of the sequence becomes in synthesised pictures (linear), and which part of it the
/// matt reflection there is, so that one sees the surface's shape.
inline constexpr double kPeakValue = 0.9, kMattShare = 0.08;

/// Whether the pictures that belong to the evidence are rendered, because a what-if synthesises the contours; else they are those
/// that were captured.
bool picturesAreSynthesised(const Inspection& inspection);
/// The frame has a photograph to show: an image or radiance of its own, or a synthesised one. A scene may give contours alone.
bool hasPhotograph(const Inspection& inspection, int frame);
/// Equal for inspections of one scene that share their pictures; "" if they were captured.
std::string pictureKey(const Inspection& inspection);

/// The picture that belongs to a frame's evidence, linear: what was captured (readLinear), or, where contours are synthesised,
/// the exact radiance at each pixel's centre under the same lights, lobe, surface and pose, in the camera's measured (distorted)
/// pixels. One exposure for the whole sequence. Radiance: the lobe alone, one channel. Image: with a matt part, three channels.
/// @param every  renders only each n-th pixel of both directions and repeats it around: a quick first look. >= 1.
/// @return as readLinear; NoHighlight if no frame of the sequence shows a highlight to expose for; of the surface where it
///         cannot be had. std::invalid_argument for a frame that does not exist. Stopped.
Outcome<Image> linearImageOf(const Inspection& inspection, int frame, FrameSource source, int every = 1,
                             const ProgressFn& progress = {});

/// The same for display: 3 channels, sRGB 0..1 (readPhotograph).
Outcome<Image> photographOf(const Inspection& inspection, int frame, int every = 1, const ProgressFn& progress = {});

}  // namespace glint
