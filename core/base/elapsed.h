// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>

namespace glint {

using Clock = std::chrono::steady_clock;
inline double microsecondsSince(Clock::time_point start) {
  return std::chrono::duration<double, std::micro>(Clock::now() - start).count();
}

}  // namespace glint
