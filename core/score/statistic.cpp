// SPDX-License-Identifier: BSD-3-Clause
#include "core/score/statistic.h"

#include <algorithm>
#include <cmath>

namespace glint {

double quantileOf(const std::vector<double>& sorted, double q) {
  if (sorted.empty()) return std::nan("");
  const double at = q * double(sorted.size() - 1);
  const std::size_t i = static_cast<std::size_t>(at);
  const double t = at - double(i);
  return i + 1 < sorted.size() ? (1 - t) * sorted[i] + t * sorted[i + 1] : sorted[i];
}

Statistic statisticOf(std::vector<double> values) {
  std::erase_if(values, [](double v) { return !std::isfinite(v); });
  std::sort(values.begin(), values.end());
  Statistic s;
  s.count = static_cast<int>(values.size());
  double sum = 0;
  for (const double v : values) sum += v;
  s.mean = values.empty() ? std::nan("") : sum / double(values.size());
  s.median = quantileOf(values, 0.5);
  s.p95 = quantileOf(values, 0.95);
  s.max = values.empty() ? std::nan("") : values.back();
  return s;
}

}  // namespace glint
