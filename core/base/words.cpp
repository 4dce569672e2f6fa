// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/words.h"

#include <algorithm>
#include <numeric>

namespace glint {

int editDistance(const std::string& a, const std::string& b) {
  // Rows of the table of distances between the beginnings of both: two before, one before, and this one.
  std::vector<int> before(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  std::iota(last.begin(), last.end(), 0);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = static_cast<int>(i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const int replaced = last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      row[j] = std::min({replaced, last[j] + 1, row[j - 1] + 1});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) row[j] = std::min(row[j], before[j - 2] + 1);
    }
    std::swap(before, last);
    std::swap(last, row);
  }
  return last[b.size()];
}

std::string similarName(const std::string& given, const std::vector<std::string>& known) {
  constexpr std::size_t kLongest = 100;  // bytes: of a name that was typed
  if (given.empty() || given.size() > kLongest) return "";
  std::string best;
  int least = std::max(1, static_cast<int>(given.size()) / 3) + 1;
  for (const std::string& name : known) {
    if (name.size() > kLongest) continue;
    const int distance = editDistance(given, name);
    if (distance >= least || distance == 0) continue;
    least = distance;
    best = name;
  }
  return best;
}

std::string didYouMean(const std::string& given, const std::vector<std::string>& known) {
  const std::string name = similarName(given, known);
  return name.empty() ? "" : "; did you mean '" + name + "'?";
}

}  // namespace glint
