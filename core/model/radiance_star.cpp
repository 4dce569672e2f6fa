// SPDX-License-Identifier: BSD-3-Clause
#include "core/model/radiance_star.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/model/star_level_set.h"
#include "core/reflectance/lobe_terms.h"

namespace glint {
namespace {

constexpr double kSamePeakPx = 0.05;  // as RadianceField::peaks

}  // namespace

Outcome<std::vector<PredictedHighlight>> radianceStars(const RadianceField& radiance, const ReflectanceFit& fit,
                                                       const Light& light, const std::vector<BrightestPoint>& mirrorPoints,
                                                       double faintest, const Camera& camera, const Surface& surface,
                                                       const Settings& settings) {
  const double rise = -std::log(fit.level);
  StarField field{[&](const SurfacePoint& at) {
                    // Above any floor, so that no shadow is asked for.
                    const std::optional<double> log = radiance.at(at, std::numeric_limits<double>::infinity());
                    return log ? -*log : std::nan("");
                  },
                  light, reachOf(fit.shape) * light.homogeneous().w(),
                  [&](const PartBounds& parts, double highest) {
                    return Eight(largestLogRadiance(fit.lobe, fit.roughness, parts) + float(highest));
                  }};
  std::vector<Summit> summits;
  for (const BrightestPoint& b : mirrorPoints) {
    const Outcome<Summit> s = summitNear(field, camera, surface, b, rise);
    if (!s) return s.failure();
    const auto same = [&](const Summit& other) { return (other.pixel - s->pixel).norm() < kSamePeakPx; };
    if (std::none_of(summits.begin(), summits.end(), same)) summits.push_back(*s);
  }
  const auto brightest =
      std::min_element(summits.begin(), summits.end(), [](const Summit& a, const Summit& b) { return a.value < b.value; });
  if (brightest == summits.end() || !(radiance.fallOfLobe(brightest->point) < faintest))
    return Failure{Reason::NoBrightestPoint, "the brightest point is far down the lobe"};
  return starHighlights(field, camera, surface, summits, brightest->value + rise, settings);
}

}  // namespace glint
