// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace glint {

// One budget for the pixels of all frames that are worked on at the same time (Limit::ImageMemory). A few megabytes of PNG may
// hold gigabytes of pixels, and every thread works on a frame of its own.

/// Says before frames are decoded how large they are, in million pixels; the largest of this process counts.
void expectImages(double megapixels);

/// How many frames of the expected size the budget has room for, at least 1: loops take no more threads than that.
int imagesAtOnce();

/// InputError (file) if one image of this size takes more than the budget; the line names the option that raises it.
void requireRoomForImage(double megapixels, const std::string& file);

}  // namespace glint
