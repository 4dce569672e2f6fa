// SPDX-License-Identifier: BSD-3-Clause
#include "tests/io/allocation_meter.h"

#include <algorithm>
#include <cstdlib>
#include <new>

namespace glint::testing_support {
std::size_t largestAllocation = 0;
}

// In a source file of their own: where the compiler sees through them it takes new and free for a mismatch.
void* operator new(std::size_t size) {
  std::size_t& largest = glint::testing_support::largestAllocation;
  largest = std::max(largest, size);
  if (void* memory = std::malloc(size ? size : 1)) return memory;
  throw std::bad_alloc();
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
