// SPDX-License-Identifier: BSD-3-Clause
#include "core/reflectance/lobe.h"

#include <cmath>

#include "core/base/outcome.h"
#include "core/geometry/light.h"
#include "core/reflectance/added_lobe.h"
#include "core/reflectance/lobe_terms.h"

namespace glint {

std::optional<Lobe> lobeOf(const std::string& name) {
  for (const Lobe lobe : allLobes())
    if (name == nameOf(lobe)) return lobe;
  return std::nullopt;
}

const char* nameOf(Lobe lobe) {
  return profileOf(lobe) ? addedLobeName(lobe) : lobe::withLobe(lobe, [](const auto& l) { return l.kName; });
}

bool isMicrofacet(Lobe lobe) {
  return lobe::withLobe(lobe, [](const auto& l) { return l.isMicrofacet(); });
}

bool hasTwoWidths(Lobe lobe) {
  return lobe::withLobe(lobe, [](const auto& l) { return l.hasTwoWidths(); });
}

LobeAxes axesAt(Lobe lobe, const Surface& surface, const SurfacePoint& point) {
  return hasTwoWidths(lobe) ? LobeAxes(point.normal, surface.tangentAt(point)) : LobeAxes(point.normal);
}

lobe::Seen lobe::seenFrom(const Eigen::Vector3d& eye, const Surface& surface, const SurfacePoint& point) {
  return {point.position, {point.normal, surface.tangentAt(point)}, (eye - point.position).normalized()};
}

double beckmannLambda(double roughness, double tanTheta) { return lobe::beckmannLambda(roughness, tanTheta * tanTheta); }

double ggxLambda(double roughness, double tanTheta) { return lobe::ggxLambda(roughness, tanTheta * tanTheta); }

std::optional<LogRadiance> logRadiance(Lobe lobe, const Roughness& roughness, const LobeAxes& axes,
                                       const Eigen::Vector3d& toLight, const Eigen::Vector3d& toCamera) {
  require(roughness > 0 && std::isfinite(roughness.mean), "logRadiance: roughness must be positive");
  const Eigen::Vector3d& n = axes.normal;
  if (!(n.dot(toLight) > 0) || !(n.dot(toCamera) > 0)) return std::nullopt;
  if (!lobe::withLobe(lobe, [&](const auto& l) { return l.template reaches<double>(n, toLight, toCamera); })) return std::nullopt;
  const lobe::Terms<double> t = lobe::terms<double>(lobe, roughness, axes, toLight, toCamera);
  return LogRadiance{t.lobe, t.masking, t.cosines};
}

double widthOf(Lobe lobe, double roughness, double level) {
  require(roughness > 0 && std::isfinite(roughness) && level > 0 && level < 1, "widthOf: roughness and level");
  return lobe::withLobe(lobe, [&](const auto& l) {
    // The last crossing: a wide Beckmann lobe first rises, because 1 / cos^4 outweighs its exponential there.
    double low = 0, high = 1.4;  // rad; a GGX lobe with m near 1 never falls that far
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (low + high);
      (l.fall(roughness, middle) < -std::log(level) ? low : high) = middle;
    }
    return 0.5 * (low + high);
  });
}

double roughnessOf(Lobe lobe, double width, double level) {
  require(width > 0 && width < M_PI / 2 && level > 0 && level < 1, "roughnessOf: width and level");
  return lobe::withLobe(lobe, [&](const auto& l) { return l.roughnessOf(width, -std::log(level)); });
}

Eight largestLogRadiance(Lobe lobe, const Roughness& roughness, const PartBounds& parts) {
  constexpr float kRoundOff = 1e-4f;  // of log I in single precision: a dozen operations on numbers of up to some hundred
  return lobe::withLobe(lobe, [&](const auto& l) {
    // Two widths: in no direction does D fall slower than with the larger one, over pi m^2 of the mean, or mask less than with
    // the smaller.
    const double wider = l.hasTwoWidths() ? std::sqrt(std::max(roughness.ratio, 1 / roughness.ratio)) : 1;
    Eight log = l.largest(roughness.mean * wider, parts) + static_cast<float>(2 * std::log(wider));
    if (l.isMicrofacet()) log -= (4 * l.leastShadowed(static_cast<float>(roughness.mean / wider), parts.cosView)).log();
    return Eight(log - parts.lightSquared.max(1e-37f).log() + kRoundOff * (1 + log.abs()));  // 1e-37: the smallest floats
  });
}

}  // namespace glint
