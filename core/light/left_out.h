// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <vector>

namespace glint {

/// Whether a richer model predicts left-out views better than a plain one by more than the standard error of the gain: the mean
/// logarithm of their errors' ratio. False for fewer than three views, different numbers of them, or errors that are not positive
/// and finite.
/// @param richer,plain  error of every left-out view, in one unit
inline bool predictsLeftOutBetter(const std::vector<double>& richer, const std::vector<double>& plain) {
  if (richer.size() < 3 || richer.size() != plain.size()) return false;
  double mean = 0, squares = 0;
  const double n = static_cast<double>(richer.size());
  for (std::size_t i = 0; i < richer.size(); ++i) mean += std::log(plain[i] / richer[i]) / n;
  for (std::size_t i = 0; i < richer.size(); ++i) squares += std::pow(std::log(plain[i] / richer[i]) - mean, 2);
  return std::isfinite(mean) && mean > std::sqrt(squares / (n - 1) / n);
}

}  // namespace glint
