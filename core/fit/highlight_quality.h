// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "core/highlight/frame_blur.h"
#include "core/highlight/highlight.h"
#include "core/highlight/quality.h"
#include "core/reflectance/pixel_patch.h"
#include "core/scene/scene.h"

namespace glint {

/// What a frame's pixels and surface say about its highlights beside their contours.
/// @param surface  that the frame sees; null = unknown: no flags about silhouettes and mirrored rays
/// @param blur     of the frame, where its edges show one
/// @return  one for each highlight, in their order
std::vector<HighlightQuality> highlightQualities(const Frame& frame, const LinearPixels& pixels, const Surface* surface,
                                                 const std::optional<FrameBlur>& blur, const std::vector<Highlight>& highlights);

/// Where the frame has one lamp, flags highlights whose mirrored ray does not meet that of the largest one (method.md section 4):
/// another lamp's, the reflection of something else, or texture.
/// @param qualities  one for each highlight, in their order
void flagStrangers(const Frame& frame, const Surface& surface, const std::vector<Highlight>& highlights,
                   std::vector<HighlightQuality>& qualities);

}  // namespace glint
