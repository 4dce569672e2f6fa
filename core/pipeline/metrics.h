// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "core/geometry/camera.h"
#include "core/geometry/conic.h"
#include "core/geometry/polyline.h"

namespace glint {

struct Statistic {
  double mean = 0, median = 0, p95 = 0, max = 0;  ///< NaN when count is 0
  int count = 0;
};
/// NaNs are left out. p95 and median by linear interpolation between order statistics.
Statistic statisticOf(std::vector<double> values);

/// By linear interpolation between order statistics; NaN of none. @param sorted  ascending. @param q  0 .. 1
double quantileOf(const std::vector<double>& sorted, double q);

/// A contour in an image whose border cuts it.
struct ContourPart {
  using Segment = std::pair<Pixel, Pixel>;
  Polyline region;            ///< what the image shows of its inside, closed along the border
  std::vector<Segment> line;  ///< the contour, seen or not; nothing that only runs along the border
  std::vector<Segment> seen;  ///< what the image shows of it
};
/// @param gaps  segments (from vertex, to vertex) that are not part of the contour
ContourPart partInImage(const Polyline& contour, const std::vector<std::pair<int, int>>& gaps, const Camera& camera);

/// method.md section 10, predicted against observed.
struct ContourMetrics {
  double contourErrorPx = 0;   ///< symmetric mean distance over arc length; gaps are not bridged
  double contourErrorPct = 0;  ///< of the equivalent diameter of the observed region
  /// The same between the ellipse of the observed contour and the predicted ellipse; NaN without one.
  double ellipseErrorPct = 0;
  double hausdorffPx = 0;
  double iou = 0;             ///< of the filled contours
  double centreOffsetPx = 0;  ///< between area centroids
  double axisRatioError = 0;  ///< predicted/observed axis ratio difference of the fitted ellipses
  double angleErrorDeg = 0;   ///< between the major axes, 0..90; 0 when either is a circle within 1 %
  double peakOffsetPx = 0;
};

/// @param gaps  segments of `predicted` (from vertex, to vertex) that are not part of it: not sampled, no distance to them.
/// @param iou  regionIou of the two where it is known already.
/// @return values are finite, or NaN where the input does not define them (documented per field).
ContourMetrics compareContours(const Polyline& observed, const Polyline& predicted, const std::vector<std::pair<int, int>>& gaps,
                               const std::optional<Ellipse>& predictedEllipse, const Pixel& observedPeak,
                               const Pixel& predictedPeak, std::optional<double> iou = {});

/// The same where the image's border cuts the contours: distances of what is seen of each from the other, all values of the
/// regions that are seen. An error of 0 where nothing is seen of either, as inside of a highlight that fills the image.
ContourMetrics compareContours(const ContourPart& observed, const ContourPart& predicted, const Pixel& observedPeak,
                               const Pixel& predictedPeak, std::optional<double> iou = {});

/// IoU of two filled regions, each the union of closed polylines; exact up to a raster of `cellPx`.
double regionIou(const std::vector<Polyline>& a, const std::vector<Polyline>& b, double cellPx = 0.1);

/// One-to-one pairs (observed, predicted) by greatest overlap; nearest-centroid pairs are not made.
/// @param ious  if given: regionIou of every pair.
std::vector<std::pair<int, int>> matchByOverlap(const std::vector<Polyline>& observed, const std::vector<Polyline>& predicted,
                                                std::vector<double>* ious = nullptr);

}  // namespace glint
