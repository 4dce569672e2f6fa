// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "core/highlight/iso_contour.h"

namespace glint {
namespace {

constexpr double kNarrowShare = 0.1;   // of the largest disc: half the width of what counts as a streak
constexpr double kSticksOut = 0.5;     // of the opening disc: a corner of 90 degrees sticks out by 0.41 of it
constexpr double kFineCells = 8;       // samples across the opening disc's radius: distances are then right to a tenth of it
constexpr double kMostCells = 4e6;     // of the sampled region: 16 MB a picture
constexpr double kThinPx = 2;          // radius of a region in which pixels do not show what is narrow
constexpr double kLargeShare = 0.2;    // of the largest piece's area: then a neck joins two highlights, not a streak
constexpr double kRimCells = 0.5;      // from the line to the first cell outside, about
constexpr int kFrame = 2;              // cells around the region
constexpr double kFirstSamples = 128;  // across the region, to find the largest disc to half a percent

/// A closed line as a mask, `cellsPerPx` samples a pixel. Cell (i, j) has its centre at first + (i, j) / cellsPerPx.
struct SampledRegion {
  cv::Mat mask;
  Pixel first{0, 0};
  double cellsPerPx = 1;

  Pixel toCells(const Pixel& p) const { return (p - first) * cellsPerPx; }
};

SampledRegion sampledRegion(const Polyline& line, double cellsPerPx) {
  Eigen::AlignedBox2d box;
  for (const Pixel& p : line.points) box.extend(p);
  const Pixel size = box.sizes();
  const double cells = std::max(1.0, size.x()) * std::max(1.0, size.y());
  SampledRegion region;
  region.cellsPerPx = std::min(cellsPerPx, std::sqrt(kMostCells / cells));
  region.first = box.min() - Pixel::Constant(kFrame / region.cellsPerPx);
  region.mask = cv::Mat::zeros(static_cast<int>(std::ceil(size.y() * region.cellsPerPx)) + 2 * kFrame + 1,
                               static_cast<int>(std::ceil(size.x() * region.cellsPerPx)) + 2 * kFrame + 1, CV_8U);
  constexpr int kShift = 8;  // fractional bits of fillPoly
  std::vector<cv::Point> corners;
  corners.reserve(line.points.size());
  for (const Pixel& p : line.points) {
    const Pixel q = region.toCells(p) * (1 << kShift);
    corners.emplace_back(static_cast<int>(std::lround(q.x())), static_cast<int>(std::lround(q.y())));
  }
  cv::fillPoly(region.mask, std::vector<std::vector<cv::Point>>{corners}, cv::Scalar(255), cv::LINE_8, kShift);
  return region;
}

/// Distance of each cell inside to the outside, in cells, and the largest.
double depthInside(const SampledRegion& region, cv::Mat& depth) {
  cv::distanceTransform(region.mask, depth, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  double deepest = 0;
  cv::minMaxLoc(depth, nullptr, &deepest);
  return deepest;
}

/// Middles of the opening discs: what is at least `radius` cells deep, in pieces that are large.
cv::Mat middlesOf(const cv::Mat& depth, double radius) {
  const cv::Mat middles = depth >= radius;
  cv::Mat labels, stats, centroids;
  const int count = cv::connectedComponentsWithStats(middles, labels, stats, centroids, 8, CV_32S);
  int largest = 0;
  for (int i = 1; i < count; ++i) largest = std::max(largest, stats.at<int>(i, cv::CC_STAT_AREA));
  cv::Mat kept = cv::Mat::zeros(depth.size(), CV_8U);
  for (int i = 1; i < count; ++i)
    if (stats.at<int>(i, cv::CC_STAT_AREA) >= kLargeShare * largest) kept.setTo(255, labels == i);
  return kept;
}

double bilinear(const cv::Mat& values, const Pixel& cell) {
  const double u = std::clamp(cell.x(), 0.0, values.cols - 1.001), v = std::clamp(cell.y(), 0.0, values.rows - 1.001);
  const int x = static_cast<int>(u), y = static_cast<int>(v);
  const double a = u - x, b = v - y;
  const auto at = [&](int i, int j) { return static_cast<double>(values.at<float>(j, i)); };
  return (1 - b) * ((1 - a) * at(x, y) + a * at(x + 1, y)) + b * ((1 - a) * at(x, y + 1) + a * at(x + 1, y + 1));
}

}  // namespace

double largestDiscInside(const Polyline& line) {
  if (line.points.size() < 3) return 0;
  Eigen::AlignedBox2d box;
  for (const Pixel& p : line.points) box.extend(p);
  if (!(box.sizes().minCoeff() > 0) || !box.sizes().allFinite() || signedArea(line) == 0) return 0;
  const SampledRegion region = sampledRegion(line, kFirstSamples / box.sizes().minCoeff());
  cv::Mat depth;
  return std::max(0.0, depthInside(region, depth) - kRimCells) / region.cellsPerPx;
}

StreakCut withoutStreaks(const Polyline& line) {
  StreakCut result;
  result.line = line;
  result.radiusPx = largestDiscInside(line);
  if (result.radiusPx < kThinPx) return result;
  const double narrowPx = kNarrowShare * result.radiusPx;
  const SampledRegion region = sampledRegion(line, kFineCells / narrowPx);
  cv::Mat depth, away;
  depthInside(region, depth);
  const double narrow = narrowPx * region.cellsPerPx;
  const cv::Mat middles = middlesOf(depth, narrow + kRimCells);
  cv::distanceTransform(~middles, away, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  // How far each point lies outside of all opening discs, in their radii, zero at the cut.
  const std::size_t n = line.points.size();
  std::vector<double> out(n);
  for (std::size_t i = 0; i < n; ++i) out[i] = bilinear(away, region.toCells(line.points[i])) / narrow - 1 - kSticksOut;
  Polyline cut;
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t next = (i + 1) % n;
    if (out[i] <= 0) cut.points.push_back(line.points[i]);
    // A cut begins and ends between two points, so that it does not jump when the contour moves a little.
    if ((out[i] <= 0) != (out[next] <= 0))
      cut.points.push_back(line.points[i] + out[i] / (out[i] - out[next]) * (line.points[next] - line.points[i]));
  }
  if (cut.points.size() < 3) return result;
  cut = withoutRepeats(cut);
  const double before = std::abs(signedArea(line)), after = std::abs(signedArea(cut));
  if (cut.points.size() < 3 || !(after > 0)) return result;
  if (std::any_of(out.begin(), out.end(), [](double v) { return v > 0; })) {
    result.cutPx2 = std::max(0.0, before - after);
    result.line = std::move(cut);
  }
  return result;
}

}  // namespace glint
