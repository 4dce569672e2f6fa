// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "core/base/image.h"

namespace glint {

/// Standard deviation of pixel noise from the median response of a second-difference mask, blind to smooth shading.
/// @param image  one channel. @param usable  one per pixel; places that are not count nothing
/// @see Immerkaer, Fast noise variance estimation, CVIU 1996 (the mask; the median instead of the mean is for edges).
double pixelNoise(const Image& image, const std::vector<char>& usable);

}  // namespace glint
