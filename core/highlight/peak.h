// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/base/image.h"
#include "core/base/outcome.h"
#include "core/geometry/camera.h"
#include "core/highlight/highlight.h"

namespace glint {

/// Sub-pixel maximum of one highlight.
struct PeakFit {
  Pixel at{0, 0};    ///< pixels of the image given
  double value = 0;  ///< fitted maximum
  double rms = 0;    ///< of log I about the fit, weighted by I
  int pixels = 0;    ///< that entered the fit
};

/// Under the Gaussian lobe I = K exp(-(alpha/m)^2) log I is quadratic near the peak: a quadratic is fitted to log I, weighted by
/// I^2 (equal noise on I), over the connected pixels above `windowLevel` of the maximum; the window is widened (down to 0.3)
/// until it holds enough pixels. method.md section 1.
/// @param image  one channel, background removed; values <= 0 or not finite are never used.
/// @param x,y    pixel of the maximum.
/// @return TooFewPoints (narrower than a few pixels), NotConverged (no maximum inside the window: a ridge, a plateau or a
/// border).
Outcome<PeakFit> fitPeak(const Image& image, int x, int y, double windowLevel);

/// How far the peak lies outside its own contour, px; 0 where it lies inside, or beside it by at most a peak's uncertainty
/// (0.5 px). A measured peak is the maximum of the region that the contour surrounds, so one outside was moved by hand or noise,
/// and its ray does not come from the highlight. 0 where there is no contour.
double outsideOfContour(const Highlight& highlight);

}  // namespace glint
