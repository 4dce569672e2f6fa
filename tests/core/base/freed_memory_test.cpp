// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cstdlib>
#include <vector>

#include "core/base/memory.h"

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace glint::base_tests {
namespace {

// What the C library itself says of an image of 2 million pixels (8 MB): it lies in the heap, and stays there when it is freed.
TEST(FreedMemory, AnImagesMemoryStaysForTheNextOne) {
#if !defined(__GLIBC__) || defined(__SANITIZE_ADDRESS__)
  GTEST_SKIP() << "another allocator";
#else
  if (std::getenv("MALLOC_MMAP_THRESHOLD_") || std::getenv("MALLOC_TRIM_THRESHOLD_") || std::getenv("GLIBC_TUNABLES"))
    GTEST_SKIP() << "the environment says how memory is handled";
  constexpr std::size_t kImage = 8 << 20;  // bytes
  keepFreedMemory();
  const std::size_t mapped = mallinfo2().hblkhd;  // bytes in blocks that came from the system one by one
  {
    const std::vector<char> image(kImage, 1);
    ASSERT_EQ(image[kImage / 2], 1);
    EXPECT_EQ(mallinfo2().hblkhd, mapped);
  }
  EXPECT_GE(mallinfo2().fordblks, kImage);  // bytes of the heap that are free
#endif
}

}  // namespace
}  // namespace glint::base_tests
