// SPDX-License-Identifier: BSD-3-Clause
#include "core/trials/memory.h"

#include <fstream>
#include <limits>
#include <string>

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace glint {

bool restartPeakMemory() {
#ifdef __GLIBC__
  malloc_trim(0);
#endif
  // "5" resets VmHWM to the present resident size (proc(5)).
  std::ofstream file("/proc/self/clear_refs");
  file << "5" << std::flush;
  return file.good();
}

double peakMemoryMb() {
  std::ifstream file("/proc/self/status");
  for (std::string line; std::getline(file, line);)
    if (line.rfind("VmHWM:", 0) == 0) return static_cast<double>(std::stoll(line.substr(6))) / 1024;  // given in kB
  return std::numeric_limits<double>::quiet_NaN();
}

}  // namespace glint
