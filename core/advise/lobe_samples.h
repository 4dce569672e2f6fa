// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/image.h"
#include "core/geometry/light.h"
#include "core/highlight/highlight.h"
#include "core/surface/surface.h"

namespace glint {

/// One pixel of a highlight.
struct LobeSample {
  Pixel at{0, 0};        ///< ideal px
  double alpha = 0;      ///< rad, for the light given
  double logI = 0;       ///< natural logarithm of the radiance above the background
  double direction = 0;  ///< about the centroid of the contour, rad in (-pi, pi], as DirectionSample
  bool fitted = false;   ///< bright enough to enter the fit
};

/// log I = log K' - (alpha / m)^2, method.md section 1.
struct LobeFit {
  double logHeight = 0;  ///< log K'
  double m = 0;          ///< rad
  double rms = 0;        ///< of log I about the fit, weighted as the fit
  int pixels = 0;
  /// |alpha| = m sqrt(-log I/K') at a fraction of the height, rad. fraction in (0, 1].
  double alphaAt(double fraction) const;
};

/// One pixel of the lit surface around a highlight, bright or not, for lobes that need more than alpha.
struct LobePixel {
  double alpha = 0;                           ///< rad
  double radiance = 0;                        ///< above the background; negative where noise is
  Eigen::Vector3d normal, toLight, toCamera;  ///< unit, at the surface point
  double distance = 1;                        ///< m, to the light; 1 for one at infinity
};

/// The lit surface around a highlight on a grid of stored pixels, clipped ones among them: where a lobe can be drawn.
struct LobeGrid {
  Pixel first{0, 0};                             ///< stored px of cell (0, 0)
  int step = 1, width = 0, height = 0;           ///< px between cells; cells
  std::vector<std::optional<LobePixel>> places;  ///< row by row; none off the lit surface and beyond the reach
};

struct LobeSamples {
  std::vector<LobePixel> pixels;  ///< also what lies at or below the background
  std::vector<LobeSample> samples;
  std::optional<LobeFit> fit;
  std::optional<Failure> fitFailure;  ///< TooFewPoints; NotConverged if the radiance does not fall with alpha
  LobeGrid grid;
  double background = 0;  ///< at the peak, what was taken off
  int clipped = 0;        ///< pixels left out because they are saturated
};

struct LobeOptions {
  double reach = 2.2;      ///< of the contour's ellipse: a Gaussian lobe of level 0.5 has fallen to 3 % there
  double fitLevel = 0.3;   ///< fraction of the brightest pixel; fainter ones show the lobe's tail and the background's error (as
                           ///< fitPeak's widest window)
  double clipValue = 0;    ///< values at or above are saturated; 0 = none
  int mostSamples = 3000;  ///< evenly thinned to about this many: a plot shows no more
};

/// Radiance against alpha of the pixels around one highlight. The local background is fitted as detection does
/// (core/highlight/background.h). The lobe is fitted by least squares on log I weighted by I^2 (equal noise on I).
/// @param linear   1 or 3 channels (averaged), linear radiance, distorted as the camera is.
/// @param mask     optional, non-zero on the glossy object.
/// @param highlight  ideal px, with its ellipse. NotAnEllipse without one.
/// NoHighlight if nothing stands out of the background; TooFewPoints if no pixel is on the lit surface above the background.
Outcome<LobeSamples> lobeSamples(const Image& linear, const Image* mask, const Highlight& highlight, const Camera& camera,
                                 const Surface& surface, const Light& light, const LobeOptions& options = {});

}  // namespace glint
