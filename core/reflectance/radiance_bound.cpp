// SPDX-License-Identifier: BSD-3-Clause
#include "core/reflectance/radiance_bound.h"

#include "core/reflectance/lobe_terms.h"

namespace glint {

Eight largestLogRadiance(Lobe lobe, double roughness, const PartBounds& parts) {
  constexpr float kRoundOff = 1e-4f;  // of log I in single precision: a dozen operations on numbers of up to some hundred
  return lobe::withLobe(lobe, [&](const auto& l) {
    Eight log = l.largest(roughness, parts);
    if (l.isMicrofacet()) log -= (4 * l.leastShadowed(static_cast<float>(roughness), parts.cosView)).log();
    return Eight(log - parts.lightSquared.max(1e-37f).log() + kRoundOff * (1 + log.abs()));  // 1e-37: the smallest floats
  });
}

}  // namespace glint
