// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/task_memory.h"

#include <tbb/cache_aligned_allocator.h>

namespace glint {

void reserveTaskMemory() {
  constexpr std::size_t kTask = 256;  // bytes, as for a task
  tbb::cache_aligned_allocator<char> memory;
  memory.deallocate(memory.allocate(kTask), kTask);
}

}  // namespace glint
