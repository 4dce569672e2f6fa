// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/minimal_subset.h"

#include <algorithm>
#include <map>

#include "core/base/progress.h"

namespace glint {

std::vector<int> minimalSubset(std::vector<int> items, const std::function<bool(const std::vector<int>&)>& shows,
                               const std::function<bool(int, int)>& ask) {
  std::map<std::vector<int>, bool> known;
  const auto still = [&](const std::vector<int>& part) {
    const auto found = known.find(part);
    if (found != known.end()) return found->second;
    if (ask && !ask(static_cast<int>(known.size()), static_cast<int>(items.size()))) throw Stopped{};
    return known[part] = shows(part);
  };
  std::size_t chunks = 2;
  while (items.size() >= 2) {
    chunks = std::min(chunks, items.size());
    const auto cut = [&](std::size_t i) { return static_cast<std::ptrdiff_t>(i * items.size() / chunks); };
    std::vector<int> smaller;
    std::size_t next = chunks;
    // One chunk alone, then everything but one chunk (for two chunks the same).
    for (std::size_t i = 0; i < chunks && smaller.empty(); ++i) {
      const std::vector<int> chunk(items.begin() + cut(i), items.begin() + cut(i + 1));
      if (chunk.size() < items.size() && still(chunk)) {
        smaller = chunk;
        next = 2;
      }
    }
    for (std::size_t i = 0; chunks > 2 && i < chunks && smaller.empty(); ++i) {
      std::vector<int> rest(items.begin(), items.begin() + cut(i));
      rest.insert(rest.end(), items.begin() + cut(i + 1), items.end());
      if (still(rest)) {
        smaller = rest;
        next = std::max<std::size_t>(chunks - 1, 2);
      }
    }
    if (!smaller.empty()) {
      items = std::move(smaller);
      chunks = next;
    } else if (chunks < items.size()) {
      chunks = std::min(2 * chunks, items.size());
    } else {
      break;
    }
  }
  return items;
}

}  // namespace glint
