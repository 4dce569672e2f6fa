// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

namespace glint {

struct QuadratureNode {
  double x, weight;
};

/// Gauss-Legendre rule of n >= 1 nodes on [-1, 1], ascending: exact for polynomials up to degree 2 n - 1. The weights sum to 2.
std::vector<QuadratureNode> gaussLegendre(int n);

}  // namespace glint
