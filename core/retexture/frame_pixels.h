// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "core/inspect/inspection.h"

namespace glint {

/// A frame's photograph in linear light, as retexturing needs it.
struct FramePixels {
  Image linear;              ///< 3 channels, 1 = the largest code
  std::vector<char> glossy;  ///< per pixel: on the glossy object as the frame's mask has it; 1 without a mask
  std::vector<char> usable;  ///< per pixel: glossy, finite, clipped in no channel
};

/// NotSupported for a frame with radiance alone: nothing tells how bright a picture shows it. FrameUnreadable.
Outcome<FramePixels> framePixels(const Inspection& inspection, int frame);

}  // namespace glint
