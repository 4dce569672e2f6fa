// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/reflectance/lobe.h"

namespace glint::lobe {

/// Points and weights of a quadrature over the unit disc; the weights sum to 1.
struct DiscRule {
  struct Node {
    double x, y, weight;
  };
  std::vector<Node> nodes;
};

/// A rule whose error in log I is below about 1e-5 down to the foot of the highlight, for a light of `ratio` lobe widths: seven
/// points for small ones (exact for polynomials up to degree five), Gauss-Legendre in the squared radius times equal steps around
/// for larger ones. Beyond a ratio of 8 the largest rule.
/// @see Stroud, Approximate calculation of multiple integrals, 1971, formula S2 5-1 and section 2.6.
const DiscRule& discRuleFor(double ratio);

/// Angular radius of the light over the lobe's width at a point, both as angles of the direction to the light: H turns by half of
/// what L turns in the plane of incidence, and by 1 / (2 cos theta) of it across.
/// @param light  homogeneous; `radius` in its units. @param toCamera  unit.
double sizeRatio(double roughness, const Eigen::Vector3d& position, const Eigen::Vector3d& toCamera, const Eigen::Vector4d& light,
                 double radius);

}  // namespace glint::lobe
