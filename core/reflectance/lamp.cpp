// SPDX-License-Identifier: BSD-3-Clause
#include "core/reflectance/lamp.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/outcome.h"

namespace glint {

Lamp Lamp::sphere(const Light& centre, double radius) {
  require(radius >= 0 && std::isfinite(radius), "Lamp: the radius must not be negative");
  require(radius == 0 || !centre.atInfinity(), "Lamp: a light at infinity has no radius");
  Lamp lamp(centre);
  lamp.radius = radius;
  return lamp;
}

Lamp Lamp::segment(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  require(from.allFinite() && to.allFinite() && (to - from).norm() > 0, "Lamp: a segment has two ends");
  Lamp lamp(Light::at(0.5 * (from + to)));
  lamp.halfAxis = 0.5 * (to - from);
  return lamp;
}

std::optional<std::pair<Eigen::Vector3d, Eigen::Vector3d>> Lamp::ends() const {
  if (!isSegment()) return std::nullopt;
  const Eigen::Vector3d middle = centre.position();
  return std::pair(Eigen::Vector3d(middle - halfAxis), Eigen::Vector3d(middle + halfAxis));
}

namespace lobe {

LampIn<double> inWorld(const Lamp& lamp) {
  LampIn<double> in;
  in.shape = lamp.isSegment() ? LampShape::Segment : lamp.radius > 0 ? LampShape::Sphere : LampShape::Point;
  in.light = lamp.centre.homogeneous();
  in.radiusSquared = lamp.radius * lamp.radius;
  in.halfAxis = lamp.halfAxis;
  return in;
}

LampRule lampRuleFor(LampShape shape, double ratio) {
  if (shape == LampShape::Point) return {};
  if (shape == LampShape::Sphere) return {&discRuleFor(ratio), nullptr};
  // Fewest nodes whose log I agrees with 400 nodes to 1e-5, for Gaussian and GGX lobes beside and beyond the segment down to a
  // thousandth of the peak.
  struct Rung {
    double ratio;  // largest that the rule serves
    std::vector<QuadratureNode> nodes;
  };
  static const std::array<Rung, 13> ladder{{{0.1, gaussLegendre(3)},
                                            {0.35, gaussLegendre(4)},
                                            {0.5, gaussLegendre(6)},
                                            {0.75, gaussLegendre(8)},
                                            {1.0, gaussLegendre(10)},
                                            {1.5, gaussLegendre(12)},
                                            {2.0, gaussLegendre(16)},
                                            {3.0, gaussLegendre(24)},
                                            {4.0, gaussLegendre(32)},
                                            {5.0, gaussLegendre(40)},
                                            {6.5, gaussLegendre(56)},
                                            {8.0, gaussLegendre(64)},
                                            {12.0, gaussLegendre(96)}}};
  for (const Rung& rung : ladder)
    if (ratio <= rung.ratio) return {nullptr, &rung.nodes};
  return {nullptr, &ladder.back().nodes};
}

double lampRatio(double roughness, const Eigen::Vector3d& position, const Eigen::Vector3d& toCamera, const LampIn<double>& lamp) {
  if (lamp.shape == LampShape::Point) return 0;
  const double reach = lamp.shape == LampShape::Sphere ? std::sqrt(lamp.radiusSquared) : lamp.halfAxis.norm();
  return sizeRatio(roughness, position, toCamera, lamp.light, reach);
}

}  // namespace lobe
}  // namespace glint
