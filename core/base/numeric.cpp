// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/numeric.h"

#include <algorithm>
#include <boost/math/special_functions/legendre.hpp>

#include "core/base/outcome.h"

namespace glint {

std::vector<QuadratureNode> gaussLegendre(int n) {
  require(n >= 1, "gaussLegendre: at least one node");
  std::vector<QuadratureNode> rule;
  for (const double x : boost::math::legendre_p_zeros<double>(n)) {  // those that are not negative, ascending
    const double slope = boost::math::legendre_p_prime(n, x), weight = 2 / ((1 - x * x) * slope * slope);
    rule.push_back({x, weight});
    if (x > 0) rule.push_back({-x, weight});
  }
  std::sort(rule.begin(), rule.end(), [](const QuadratureNode& a, const QuadratureNode& b) { return a.x < b.x; });
  return rule;
}

}  // namespace glint
