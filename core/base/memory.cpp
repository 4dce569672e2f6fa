// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/memory.h"

#include <tbb/cache_aligned_allocator.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdlib>

#include "core/base/limits.h"

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace glint {

void keepFreedMemory() {
#ifdef __GLIBC__
  for (const char* const variable : std::array{"MALLOC_MMAP_THRESHOLD_", "MALLOC_TRIM_THRESHOLD_", "GLIBC_TUNABLES"})
    if (std::getenv(variable)) return;
  constexpr int kLargestBlock = 32 << 20;  // bytes; glibc takes no more. An image of 8 million pixels in single precision
  constexpr int kKept = 64 << 20;          // bytes, at the end of the memory that the threads share
  mallopt(M_MMAP_THRESHOLD, kLargestBlock);
  mallopt(M_TRIM_THRESHOLD, kKept);
#endif
}

void reserveTaskMemory() {
  constexpr std::size_t kTask = 256;  // bytes, as for a task
  tbb::cache_aligned_allocator<char> memory;
  memory.deallocate(memory.allocate(kTask), kTask);
}

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
