// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <string>
#include <vector>

namespace glint {

/// "0, 3, 7 and 5 more": at most eight of these words.
inline std::string shortList(const std::vector<std::string>& words) {
  constexpr std::size_t kNamed = 8;  // more than a reader compares at a glance
  std::string text;
  for (std::size_t i = 0; i < std::min(kNamed, words.size()); ++i) text += (i ? ", " : "") + words[i];
  if (words.size() > kNamed) text += " and " + std::to_string(words.size() - kNamed) + " more";
  return text;
}

inline std::string shortList(const std::vector<int>& numbers) {
  std::vector<std::string> words;
  for (const int number : numbers) words.push_back(std::to_string(number));
  return shortList(words);
}

}  // namespace glint
