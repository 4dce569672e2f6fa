// SPDX-License-Identifier: BSD-3-Clause
#include "core/capture/time_pairs.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <queue>
#include <tuple>

namespace glint::capture {

double secondsOf(double time) {
  constexpr double kMostSeconds = 1e11, kThousand = 1e3;
  for (double unit = 1;; unit *= kThousand)
    if (!(std::abs(time) >= kMostSeconds * unit) || unit >= 1e9) return time / unit;
}

std::vector<std::size_t> timePairs(const std::vector<double>& times, const std::vector<double>& others) {
  struct Moment {
    double time;
    bool isOther;
    std::size_t index, before, after;
  };
  std::vector<Moment> line;
  for (std::size_t i = 0; i < times.size(); ++i) line.push_back({times[i], false, i, 0, 0});
  for (std::size_t i = 0; i < others.size(); ++i) line.push_back({others[i], true, i, 0, 0});
  std::sort(line.begin(), line.end(), [](const Moment& a, const Moment& b) {
    return std::tie(a.time, a.isOther, a.index) < std::tie(b.time, b.isOther, b.index);
  });
  struct Neighbours {
    double apart;
    std::size_t left, right;
    bool operator>(const Neighbours& b) const { return std::tie(apart, left) > std::tie(b.apart, b.left); }
  };
  std::priority_queue<Neighbours, std::vector<Neighbours>, std::greater<>> closest;
  const auto consider = [&](std::size_t left, std::size_t right) {
    if (left == kNoPair || right >= line.size() || line[left].isOther == line[right].isOther) return;
    const double apart = line[right].time - line[left].time;
    if (apart <= kApart) closest.push({apart, left, right});
  };
  for (std::size_t i = 0; i < line.size(); ++i) {
    line[i].before = i - 1;  // of the first: kNoPair
    line[i].after = i + 1;
    consider(i, i + 1);
  }
  std::vector<std::size_t> pairs(times.size(), kNoPair);
  std::vector<char> used(line.size());
  while (!closest.empty()) {
    const auto [apart, left, right] = closest.top();
    closest.pop();
    if (used[left] || used[right]) continue;
    used[left] = used[right] = true;
    const bool turned = line[left].isOther;
    pairs[line[turned ? right : left].index] = line[turned ? left : right].index;
    const std::size_t before = line[left].before, after = line[right].after;
    if (before != kNoPair) line[before].after = after;
    if (after < line.size()) line[after].before = before;
    consider(before, after);
  }
  return pairs;
}

}  // namespace glint::capture
