// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/image.h"
#include "core/base/outcome.h"
#include "core/geometry/conic.h"
#include "core/geometry/polyline.h"

namespace glint {

/// One contour of the slope around a clipped core.
struct FlankLevel {
  double value = 0;  ///< radiance above the background
  Polyline contour;  ///< closed
  double areaPx2 = 0;
  std::optional<Ellipse> ellipse;  ///< least-squares ellipse of the contour
  double outOfRound = 0;           ///< rms distance of the contour from the ellipse, as a share of its radii; 0 without one
};

/// What a fit needs of it.
struct FlankSample {
  double value = 0;  ///< above the background, > 0
  double areaPx2 = 0;
  double logSigma = 0;  ///< standard deviation of log(value), noise and pixels; what no profile explains is added by the fit
};

/// The unclipped peak that continues a flank: I(A) = K (1 + (A/A0)^p / beta)^-beta, A the area of the contour at I.
/// With beta < 0 the lobe ends where the bracket is 0.
struct FlankPeak {
  double value = 0;     ///< K, above the background
  double logSigma = 0;  ///< standard deviation of log K: noise, background, the profile's shape
  double areaPx2 = 0;   ///< A0
  double shape = 1;     ///< p: 1 of a lobe under a small lamp, above 1 flat-topped (a large lamp), below 1 pointed
  double tail = 0;      ///< 1/beta: 0 Gaussian, 1/2 GGX, below 0 a lobe that ends
  double misfit = 0;    ///< rms of log(value) about the profile

  double areaAt(double value) const;    ///< of the contour at a value below K, px^2; 0 at K and above
  double fallAt(double areaPx2) const;  ///< value of the contour of that area, as a share of K; 1 at areas of 0 and less
};

/// The slope around the clipped core of one highlight.
struct ClippedFlank {
  double clipHeight = 0;  ///< lowest value above the background at which a channel is clipped: what lies below it is whole
  std::vector<FlankLevel> levels;  ///< highest first
  std::optional<FlankPeak> peak;   ///< where the levels tell one
  std::string reason;              ///< in words: why they tell no peak, or why it is not trusted
  bool trusted = false;            ///< the peak is known well enough to set the level of contours
  double levelAsked = 0.5;
  double contourValue = 0;     ///< at which the highlight's contour was taken, above the background
  bool outsideCore = false;    ///< the contour lies at the level asked for, of the estimated peak, outside of the clipped core
  double backgroundSigma = 0;  ///< of the background that was taken off
  /// How far the contour may be from that at the level asked for (standard deviation, px). Outside of the core: what the
  /// uncertainties of peak and background move it. Else the contour is too large: by the distance to where the profile has the
  /// level, and its uncertainty; without a trusted peak, anything up to the whole radius is as likely.
  double sigmaPx = 0;
};

/// Fits the profile to the areas of the levels: log K, A0, p and an offset of the background per beta, nine of them. Averages the
/// answers by how well they explain the levels; their scatter adds to the uncertainty. Misses a narrow peak on top of the core
/// of which the flank shows nothing. @param samples  at least five, any order. @param backgroundSigma  as in FlankView
/// @return TooFewPoints; NotFinite (a value or an area is not positive and finite); NotConverged (areas do not grow as values
///         fall, or so little that the slope does not show how high it rises)
Outcome<FlankPeak> peakFromFlank(std::span<const FlankSample> samples, double backgroundSigma);

/// Pixels around one clipped highlight; all maps have the size of `corrected`, one entry per pixel.
struct FlankView {
  Image corrected;              ///< one channel, background removed; 0 on pixels that are not usable
  std::vector<char> usable;     ///< finite, not negative, on the glossy object
  std::vector<char> saturated;  ///< of this highlight
  double noise = 0;             ///< standard deviation of a pixel
  double backgroundSigma = 0;   ///< of the background that was taken off
  double minAreaPx2 = 12;
};

/// Traces the slope at up to eleven levels, from just below the clipped core down to noise, without streaks, while the contours
/// belong to one highlight (nested, alike, growing no faster than a lobe's, on usable pixels, in view). Estimates the peak.
ClippedFlank traceFlank(const FlankView& view);

/// The contour at `level` of the estimated peak lies outside of the clipped core, and the peak is trusted.
bool reachesLevel(const ClippedFlank& flank, double level);

/// Notes at which value the contour was taken, and what the peak's uncertainty does to it.
/// @param reference  above the background, whose fraction `level` the value is: the peak of this flank, or a stronger one
void noteContour(ClippedFlank& flank, double level, double reference, const Polyline& contour);

/// Where the contour lies and why, in words.
std::string inWords(const ClippedFlank& flank);

}  // namespace glint
