// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

namespace glint::testing_support {

/// Under a sanitizer a fit takes some fifteen times as long, and the first case runs the same code as the others.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif

/// How long a test of the window waits for results, ms.
inline constexpr int kWaitMs = kSanitized ? 600000 : 60000;

/// The cases of a test; the first alone under a sanitizer.
template <class T>
std::vector<T> cases(std::vector<T> all) {
  if (kSanitized) all.resize(1);
  return all;
}

}  // namespace glint::testing_support
