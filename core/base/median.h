// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace glint {

/// The value that sorting would put at `place`. Reorders `values`. Linear time.
template <class T>
T& ranked(std::vector<T>& values, std::size_t place) {
  const auto nth = values.begin() + static_cast<std::ptrdiff_t>(place);
  std::nth_element(values.begin(), nth, values.end());
  return *nth;
}

/// The middle one of values, of which there is at least one; of an even number the upper one of the middle two. (Boost's median
/// takes their mean: results that sessions store would change.)
template <class T>
T upperMedian(std::vector<T> values) {
  return ranked(values, values.size() / 2);
}

}  // namespace glint
