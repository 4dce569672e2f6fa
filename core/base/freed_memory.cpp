// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/freed_memory.h"

#include <array>
#include <cstdlib>

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

}  // namespace glint
