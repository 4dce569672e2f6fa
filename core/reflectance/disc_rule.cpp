// SPDX-License-Identifier: BSD-3-Clause
#include "core/reflectance/disc_rule.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace glint::lobe {
namespace {

/// Nodes and weights of Gauss-Legendre quadrature on [0, 1], by Newton's method on the Legendre polynomial.
std::vector<std::pair<double, double>> gaussLegendre(int n) {
  std::vector<std::pair<double, double>> rule;
  for (int i = 0; i < n; ++i) {
    double x = std::cos(M_PI * (i + 0.75) / (n + 0.5)), slope = 1;
    for (int round = 0; round < 20; ++round) {
      double before = 1, value = x;
      for (int k = 2; k <= n; ++k) {
        const double next = ((2 * k - 1) * x * value - (k - 1) * before) / k;
        before = value;
        value = next;
      }
      slope = n * (x * value - before) / (x * x - 1);
      x -= value / slope;
    }
    rule.emplace_back(0.5 * (1 + x), 1 / ((1 - x * x) * slope * slope));
  }
  return rule;
}

DiscRule productRule(int rings, int spokes) {
  DiscRule rule;
  int ring = 0;
  for (const auto& [square, weight] : gaussLegendre(rings)) {
    for (int k = 0; k < spokes; ++k) {
      const double angle = 2 * M_PI * (k + 0.5 * (ring % 2)) / spokes, r = std::sqrt(square);
      rule.nodes.push_back({r * std::cos(angle), r * std::sin(angle), weight / spokes});
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
