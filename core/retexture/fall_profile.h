// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "core/base/outcome.h"

namespace glint {

/// How the radiance of a highlight falls from its brightest place, learned from pixels: f(rho), 1 at rho = 0, never rising, 0
/// from kEnd on. rho is 1 on the highlight's contour: alpha over the limit angle, or the distance from the brightest place over
/// that of the contour in the same direction.
class FallProfile {
 public:
  static constexpr double kEnd = 4;  ///< rho: the background of a highlight is told from pixels no farther than this

  struct Sample {
    double rho;    ///< >= 0
    double value;  ///< radiance above the background, as a multiple of that on the contour
  };
  /// Medians over steps of rho, made monotone by pooling adjacent violators; where the core has no samples (it is clipped), the
  /// Gaussian lobe exp(-k rho^2) that continues the pixels around it. Samples that are not finite are left out.
  /// TooFewPoints: less than kLeastSamples, or none inside or on the contour; NoHighlight: the values do not fall outwards.
  /// @see Barlow, Bartholomew, Bremner, Brunk, Statistical inference under order restrictions, 1972 (pooling adjacent violators).
  static Outcome<FallProfile> learn(const std::vector<Sample>& samples);
  static constexpr int kLeastSamples = 30;  ///< a few in each step that matters

  /// @param rho  >= 0, finite.
  double at(double rho) const;
  double observedFrom() const { return observedFrom_; }  ///< below this rho the core is extrapolated; 0 = none of it
  double beforeEnd() const { return beforeEnd_; }        ///< share of the peak where the profile begins to fade out to its end
  double peakOverContour() const { return peakOverContour_; }  ///< value at rho = 0 in the unit of the samples

 private:
  FallProfile() = default;
  std::vector<double> share_;  ///< at the middles of the steps
  double observedFrom_ = 0, beforeEnd_ = 0, peakOverContour_ = 1;
};

}  // namespace glint
