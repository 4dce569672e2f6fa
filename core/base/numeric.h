// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Small numerics: angles, order statistics, quadrature.
#include <algorithm>
#include <cstddef>
#include <numbers>
#include <vector>

namespace glint {

/// Angles are radians everywhere; degrees are for people and files.
constexpr double degrees(double rad) { return rad * (180 / std::numbers::pi); }
constexpr double radians(double deg) { return deg * (std::numbers::pi / 180); }

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

struct QuadratureNode {
  double x, weight;
};

/// Gauss-Legendre rule of n >= 1 nodes on [-1, 1], ascending: exact for polynomials up to degree 2 n - 1. The weights sum to 2.
std::vector<QuadratureNode> gaussLegendre(int n);

}  // namespace glint
