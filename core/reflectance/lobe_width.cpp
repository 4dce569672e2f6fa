// SPDX-License-Identifier: BSD-3-Clause
#include "core/reflectance/lobe_width.h"

#include <algorithm>
#include <cmath>

#include "core/base/outcome.h"
#include "core/reflectance/added_lobe.h"

namespace glint {
namespace {

constexpr double kWidestAngle = 1.4;  // rad

/// log of the lobe's value in the mirror direction over that at theta.
double fall(Lobe lobe, double m, double theta) {
  const double t2 = std::pow(std::tan(theta), 2), logCos = std::log(std::cos(theta));
  switch (lobe) {
    case Lobe::TorranceSparrow: return t2 / (m * m) + 4 * logCos;
    case Lobe::Ggx: return 2 * std::log1p(t2 / (m * m)) + 4 * logCos;
    case Lobe::BlinnPhong: return -2 / (m * m) * logCos;
    case Lobe::Phong: return 2 * theta < M_PI / 2 ? -std::log(std::cos(2 * theta)) / (2 * m * m) : HUGE_VAL;
  }
  const LobeProfile& added = *profileOf(lobe);
  return added.logDistribution(m, 0).value - added.logDistribution(m, t2).value;
}

/// A wider lobe falls less at one angle: bisection in log m.
double addedRoughnessOf(Lobe lobe, double width, double depth) {
  double low = std::log(1e-5), high = std::log(10.0);  // a mirror's, and a lobe that is wider than any hemisphere
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (fall(lobe, std::exp(middle), width) > depth ? low : high) = middle;
  }
  return std::exp(0.5 * (low + high));
}

}  // namespace

double widthOf(Lobe lobe, double roughness, double level) {
  require(roughness > 0 && std::isfinite(roughness) && level > 0 && level < 1, "widthOf: roughness and level");
  // The last crossing: a wide Beckmann lobe first rises, because 1 / cos^4 outweighs its exponential there.
  double low = 0, high = kWidestAngle;  // a GGX lobe with m near 1 never falls that far
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (fall(lobe, roughness, middle) < -std::log(level) ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

double roughnessOf(Lobe lobe, double width, double level) {
  require(width > 0 && width < M_PI / 2 && level > 0 && level < 1, "roughnessOf: width and level");
  const double depth = -std::log(level), t2 = std::pow(std::tan(width), 2), logCos = std::log(std::cos(width));
  switch (lobe) {
    case Lobe::TorranceSparrow: return std::sqrt(t2 / (depth - 4 * logCos));
    case Lobe::Ggx: return std::sqrt(t2 / std::expm1(0.5 * (depth - 4 * logCos)));
    case Lobe::BlinnPhong: return std::sqrt(-2 * logCos / depth);
    case Lobe::Phong: return std::sqrt(-std::log(std::cos(2 * std::min(width, 0.249 * M_PI))) / (2 * depth));
  }
  return addedRoughnessOf(lobe, width, depth);
}

}  // namespace glint
