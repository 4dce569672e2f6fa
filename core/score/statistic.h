// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

namespace glint {

struct Statistic {
  double mean = 0, median = 0, p95 = 0, max = 0;  ///< NaN when count is 0
  int count = 0;
};
/// NaNs are left out. p95 and median by linear interpolation between order statistics.
Statistic statisticOf(std::vector<double> values);

/// By linear interpolation between order statistics; NaN of none. @param sorted  ascending. @param q  0 .. 1
double quantileOf(const std::vector<double>& sorted, double q);

}  // namespace glint
