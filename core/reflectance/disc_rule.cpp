// SPDX-License-Identifier: BSD-3-Clause
#include "core/reflectance/disc_rule.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/numeric.h"

namespace glint::lobe {
namespace {

DiscRule productRule(int rings, int spokes) {
  DiscRule rule;
  int ring = 0;
  for (const QuadratureNode& node : gaussLegendre(rings)) {
    const double r = std::sqrt(0.5 * (1 + node.x));  // equal steps of the squared radius are equal areas
    for (int k = 0; k < spokes; ++k) {
      const double angle = 2 * M_PI * (k + 0.5 * (ring % 2)) / spokes;
      rule.nodes.push_back({r * std::cos(angle), r * std::sin(angle), 0.5 * node.weight / spokes});
    }
    ++ring;
  }
  return rule;
}

DiscRule sevenPoints() {
  DiscRule rule;
  rule.nodes.push_back({0, 0, 0.25});
  for (int k = 0; k < 6; ++k)
    rule.nodes.push_back({std::sqrt(2.0 / 3) * std::cos(k * M_PI / 3), std::sqrt(2.0 / 3) * std::sin(k * M_PI / 3), 0.125});
  return rule;
}

struct Rung {
  double ratio;  ///< largest that the rule serves
  DiscRule rule;
};

}  // namespace

const DiscRule& discRuleFor(double ratio) {
  // Smallest rules whose log I agrees with one of 120 x 360 points to 1e-5, for Gaussian and GGX lobes at all distances from the
  // light's middle down to a thousandth of the peak.
  static const std::array<Rung, 11> ladder{{{0.15, sevenPoints()},
                                            {0.35, productRule(2, 8)},
                                            {0.5, productRule(3, 10)},
                                            {0.75, productRule(4, 12)},
                                            {1.0, productRule(4, 14)},
                                            {1.5, productRule(6, 20)},
                                            {2.0, productRule(8, 24)},
                                            {3.0, productRule(12, 32)},
                                            {5.0, productRule(20, 48)},
                                            {6.5, productRule(26, 64)},
                                            {8.0, productRule(32, 80)}}};
  for (const Rung& rung : ladder)
    if (ratio <= rung.ratio) return rung.rule;
  return ladder.back().rule;
}

double sizeRatio(double roughness, const Eigen::Vector3d& position, const Eigen::Vector3d& toCamera, const Eigen::Vector4d& light,
                 double radius) {
  const Eigen::Vector3d offset = light.head<3>() - light.w() * position;
  const double distance = offset.norm();
  const double cosine = 0.5 * (offset / distance + toCamera).norm();  // of the angle of incidence on the facets that mirror
  return std::abs(light.w()) * radius / distance / (2 * roughness * std::max(cosine, 1e-3));
}

}  // namespace glint::lobe
