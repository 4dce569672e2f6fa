// SPDX-License-Identifier: BSD-3-Clause
#include "core/reflectance/radiance_bound.h"

#include <algorithm>
#include <cmath>

#include "core/reflectance/added_lobe.h"

namespace glint {
namespace {

constexpr float kNoBound = 1e30f;   // no part is ruled out
constexpr float kRoundOff = 1e-4f;  // of log I in single precision: a dozen operations on numbers of up to some hundred

/// cos theta_V (1 + Lambda(V)) grows with cos theta_V and stays above these where V is at the horizon: m/2 for GGX, m/(2
/// sqrt(pi)) for Beckmann slopes.
Eight leastShadowedCosine(Lobe lobe, float m, const Eight& cosView) {
  if (lobe == Lobe::Ggx) {
    const float m2 = std::min(1.f, m * m);
    return 0.5f * (cosView + (cosView.square() * (1 - m2) + m2).sqrt());
  }
  if (profileOf(lobe)) return cosView.max(1e-6f);  // a Lambda that is not known may be 0
  return cosView.max(0.27f * std::min(1.f, m));
}

/// log(1 + x). Unlike log1p it is computed eight at a time; what it loses (6e-8, absolute) is below the margin for round-off.
Eight ofOneAnd(const Eight& x) { return (1 + x).log(); }

}  // namespace

Eight largestLogRadiance(Lobe lobe, double roughness, const PartBounds& parts) {
  const float m = static_cast<float>(roughness), m2 = m * m;
  const Eight& t = parts.tanSquared;
  Eight log;
  switch (lobe) {
    case Lobe::Phong:
      // sin^2 of half the angle between R and V is sin^2(theta_h) (cos^2 b + sin^2 b cos^2 f), b half the angle between L and V.
      // log1p: a narrow lobe makes much of the round-off of 1 - x. The log of 0 is not finite.
      log = 0.5f / m2 * (-2 * t / (1 + t) * parts.cosHalf.square()).max(-1 + 1e-7f).log1p();
      break;
    case Lobe::BlinnPhong:
      log = -1 / m2 * t.log1p();  // as for Phong
      break;
    case Lobe::TorranceSparrow: {
      // -t/m^2 + 2 log(1 + t) rises up to t = 2 m^2 - 1 for lobes wider than that.
      const Eight at = t.max(2 * m2 - 1);
      log = -at / m2 + 2 * ofOneAnd(at) - std::log(float(M_PI) * m2);
      break;
    }
    case Lobe::Ggx:
      // Rises with t where m > 1, towards 4 log m.
      log = m <= 1 ? Eight(2 * (ofOneAnd(t) - ofOneAnd(t / m2)) - std::log(float(M_PI) * m2))
                   : Eight(Eight::Constant(4 * std::log(m) - std::log(float(M_PI) * m2)));
      break;
    default: {  // one of a plugin, which does not rise with t
      const LobeProfile& added = *profileOf(lobe);
      if (roughness > kCheckedRoughness) return Eight::Constant(kNoBound);
      for (Eigen::Index i = 0; i < log.size(); ++i) log[i] = float(added.logDistribution(roughness, std::max(0.f, t[i])).value);
    }
  }
  if (isMicrofacet(lobe)) log -= (4 * leastShadowedCosine(lobe, m, parts.cosView)).log();
  return log - parts.lightSquared.max(1e-37f).log() + kRoundOff * (1 + log.abs());  // 1e-37: the smallest floats
}

}  // namespace glint
