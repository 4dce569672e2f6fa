// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/image_memory.h"

#include <algorithm>
#include <atomic>

#include "core/base/limits.h"

namespace glint {
namespace {

/// Memory of a pixel in a frame at work: the file's own values, three channels of float, and copies of a detection. Measured
/// at 16 (8-bit grey) to 23 (16-bit colour).
constexpr double kBytesPerPixel = 24;

std::atomic<double> largest{0};  // million pixels

}  // namespace

void expectImages(double megapixels) {
  for (double known = largest; megapixels > known && !largest.compare_exchange_weak(known, megapixels);) continue;
}

int imagesAtOnce() {
  constexpr double kMany = 1000;  // more threads than any machine of today has
  const double each = largest * kBytesPerPixel;
  return each > 0 ? int(std::clamp(limitOf(Limit::ImageMemory) / each, 1.0, kMany)) : int(kMany);
}

void requireRoomForImage(double megapixels, const std::string& file) {
  requireWithin(Limit::ImageMemory, megapixels * kBytesPerPixel, file);
}

}  // namespace glint
