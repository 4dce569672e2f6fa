// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <string>
#include <vector>

namespace glint {

/// "0, 3, 7 and 5 more": at most eight numbers.
inline std::string shortList(const std::vector<int>& numbers) {
  constexpr std::size_t kNamed = 8;  // more than a reader compares at a glance
  std::string text;
  for (std::size_t i = 0; i < std::min(kNamed, numbers.size()); ++i) text += (i ? ", " : "") + std::to_string(numbers[i]);
  if (numbers.size() > kNamed) text += " and " + std::to_string(numbers.size() - kNamed) + " more";
  return text;
}

}  // namespace glint
