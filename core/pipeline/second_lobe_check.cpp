// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/second_lobe_check.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/evenly.h"
#include "core/base/number_text.h"
#include "core/pipeline/known_lamps.h"

namespace glint {
namespace {

// Half angles: a tenth of the peak between one and the next. Below, it is the highlight's own tail.
constexpr std::array kWider{3.5, 5.0, 7.0, 10.0, 14.0};
constexpr double kGgxHalf = 0.41421356;    // sqrt(2) - 1: GGX's fall has half of its peak at the half angle
constexpr double kLeastOfPeak = 0.02;      // of the peak, three radii off: a tail that GGX misses by a fifth leaves half of it
constexpr double kSureOf = 8;              // standard deviations; neighbouring points are not independent
constexpr double kLeftBy = 0.7;            // of what the views disagree by, that remains at most
constexpr std::size_t kAskedPoints = 400;  // for one share and one width
constexpr double kAgreeing = 0.003;        // of the light: views that agree so well leave no room for the least share
constexpr double kFirstSeen = 3;           // radii of a spot: nearer points are left out

}  // namespace

std::optional<SecondLobe> secondLobeOf(const TexturePanel& panel, const std::vector<PointSamples>& points, const Light& light,
                                       double halfAngle) {
  if (points.empty() || !(halfAngle > 0)) return std::nullopt;
  const std::vector<PointSamples> some = evenly(points, kAskedPoints);
  const Lamp lamp(light.homogeneous(), {});
  double peak = 0;
  for (const TextureView& view : panel.views())
    for (const LobeSpot& spot : view.spots) peak = std::max(peak, spot.peak);
  // The highlight's own long tail by its half angle; that of the spots' ellipses is a rougher one.
  const auto fallsOver = [&](std::optional<double> width) {
    return [&, width](const TexturePanel::Sample& s, double mean) {
      const double angle = halfAngleAt(s.point, panel.views()[s.view].camera, lamp), unit = peak / mean;
      std::vector<double> terms{unit * std::pow(1 + kGgxHalf * std::pow(angle / halfAngle, 2), -2)};
      if (width) terms.push_back(unit * std::exp2(-std::pow(angle / *width, 2)));
      return terms;
    };
  };
  std::optional<SecondLobe> best;
  const SightingFit without = fittedSightings(some, panel.views().size(), fallsOver(std::nullopt));
  if (!(without.left > kAgreeing * kAgreeing * static_cast<double>(without.samples))) return std::nullopt;
  double least = kLeftBy * without.left;
  for (const double wider : kWider) {
    const SightingFit fit = fittedSightings(some, panel.views().size(), fallsOver(wider * halfAngle));
    const double share = fit.terms(1), sigma = fit.sigma(1), firstSeen = share * std::exp2(-std::pow(kFirstSeen / wider, 2));
    if (!(firstSeen > kLeastOfPeak && share > kSureOf * sigma && fit.left < least)) continue;
    least = fit.left;
    best = SecondLobe{share, sigma, wider};
  }
  return best;
}

std::string secondLobeRemark(const std::optional<SecondLobe>& found) {
  if (!found) return "";
  return formatted(
      "a second lobe lies under the highlights, about %.2g times as wide and with %.2g %% of their peak (a coat over a rough "
      "base, "
      "or glow): contours take it for shading, and are off by some of it",
      found->timesWider, 100 * found->share);
}

}  // namespace glint
