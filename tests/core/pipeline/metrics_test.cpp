// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/metrics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/pipeline/summary.h"

namespace glint {
namespace {

constexpr int kVertices = 1440;
// A regular polygon of n vertices lies inside its circle by r (1 - cos(pi/n)), on average 2/3 of that: 3.2e-4 px at r = 200.
constexpr double kPolygon = 5e-4;

Polyline circle(double x, double y, double r, int n = kVertices) { return {Ellipse{{x, y}, {r, r}, 0}.sample(n), true}; }

ContourMetrics compare(const Polyline& a, const Polyline& b, const std::vector<std::pair<int, int>>& gaps = {}) {
  return compareContours(a, b, gaps, std::nullopt, {0, 0}, {3, 4});
}

TEST(ContourMetrics, ConcentricCirclesDifferByTheirRadii) {
  const ContourMetrics m = compare(circle(300, 200, 50), circle(300, 200, 55));
  EXPECT_NEAR(m.contourErrorPx, 5, kPolygon);
  EXPECT_NEAR(m.contourErrorPct, 5, kPolygon);  // equivalent diameter 100
  EXPECT_NEAR(m.ellipseErrorPct, 5, kPolygon);
  EXPECT_NEAR(m.hausdorffPx, 5, kPolygon);
  EXPECT_NEAR(m.iou, (50.0 * 50) / (55.0 * 55), 1e-4);
  EXPECT_NEAR(m.centreOffsetPx, 0, 1e-9);
  EXPECT_NEAR(m.peakOffsetPx, 5, 1e-12);
}

TEST(ContourMetrics, ScaleChangesPixelsButNotPercent) {
  for (const double k : {0.02, 1.0, 40.0}) {
    const ContourMetrics m = compare(circle(300 * k, 200 * k, 50 * k), circle(303 * k, 200 * k, 50 * k));
    const ContourMetrics one = compare(circle(300, 200, 50), circle(303, 200, 50));
    EXPECT_NEAR(m.contourErrorPct, one.contourErrorPct, 2e-3 * one.contourErrorPct)
        << k;  // the number of samples depends on the size
    EXPECT_NEAR(m.contourErrorPx / k, one.contourErrorPx, 2e-3 * one.contourErrorPx) << k;
    EXPECT_NEAR(m.centreOffsetPx / k, 3, 1e-9);
  }
}

/// Distance from a unit circle shifted by d: | |d + u(t)| - 1 |, averaged numerically in long double.
TEST(ContourMetrics, ShiftedCircleAgreesWithQuadrature) {
  const long double r = 50, d = 3;
  long double mean = 0;
  const int n = 100000;
  for (int i = 0; i < n; ++i) {
    const long double t = 2 * std::numbers::pi_v<long double> * (i + 0.5L) / n;
    mean += std::abs(std::hypot(d + r * std::cos(t), r * std::sin(t)) - r) / n;
  }
  const ContourMetrics m = compare(circle(300, 200, 50), circle(303, 200, 50));
  EXPECT_NEAR(m.contourErrorPx, static_cast<double>(mean), 2e-3);
  EXPECT_NEAR(m.hausdorffPx, 3, 2e-3);
}

TEST(ContourMetrics, AnglesAndAxisRatios) {
  const double degree = std::numbers::pi / 180;
  const Ellipse a{{100, 100}, {40, 20}, 80 * degree}, b{{100, 100}, {40, 30}, -85 * degree};
  const ContourMetrics m = compare({a.sample(720), true}, {b.sample(720), true});
  EXPECT_NEAR(m.axisRatioError, 0.25, 1e-6);
  EXPECT_NEAR(m.angleErrorDeg, 15, 1e-4);  // an axis has no direction: 80 and -85 are 15 apart
}

TEST(ContourMetrics, GapsAreNotBridgedForDistances) {
  // A predicted square whose right side is missing, against the full square: the missing side is far from its neighbours only
  // one way, the closing chord must not count as predicted.
  const Polyline observed{{{0, 0}, {10, 0}, {10, 10}, {0, 10}}, true};
  const Polyline predicted{{{0, 0}, {10, 0}, {10, 10}, {0, 10}}, true};
  const ContourMetrics whole = compare(observed, predicted), gap = compare(observed, predicted, {{1, 2}});
  EXPECT_NEAR(whole.contourErrorPx, 0, 1e-12);
  // Observed to predicted: on the missing side the distance runs 0..5..0, mean 2.5, over a quarter of the length.
  EXPECT_NEAR(gap.contourErrorPx, 0.5 * 2.5 / 4, 1e-3);
  EXPECT_NEAR(gap.hausdorffPx, 5, 0.06);  // samples are 40/360 px apart, the nearest to the middle is half of that away
  EXPECT_NEAR(gap.iou, 1, 1e-9);          // areas are closed over the gap
}

TEST(ContourMetrics, RepeatedPointsDoNotMatter) {
  Polyline doubled;
  for (const Pixel& p : circle(50, 50, 20, 90).points) {
    doubled.points.push_back(p);
    doubled.points.push_back(p);
  }
  const ContourMetrics m = compare(doubled, circle(50, 50, 20, 90));
  EXPECT_NEAR(m.contourErrorPx, 0, 1e-9);
}

TEST(ContourMetrics, DegenerateInputGivesNaNNotZero) {
  const ContourMetrics empty = compare(circle(50, 50, 20), {{}, true});
  EXPECT_TRUE(std::isnan(empty.contourErrorPx));
  const ContourMetrics point = compare(circle(50, 50, 20), {{{1, 1}, {1, 1}}, true});
  EXPECT_TRUE(std::isnan(point.contourErrorPx));
  const ContourMetrics flat = compare({{{0, 0}, {10, 0}}, true}, circle(5, 0, 5));
  EXPECT_TRUE(std::isnan(flat.contourErrorPct));
}

TEST(RegionIou, UnionOfOverlappingRegionsCountsOnce) {
  const Polyline a{{{0, 0}, {10, 0}, {10, 10}, {0, 10}}, true}, b{{{5, 0}, {15, 0}, {15, 10}, {5, 10}}, true};
  const Polyline both{{{0, 0}, {15, 0}, {15, 10}, {0, 10}}, true};
  EXPECT_NEAR(regionIou({a, b}, {both}), 1, 1e-9);
  EXPECT_NEAR(regionIou({a}, {b}), 1.0 / 3, 1e-9);
  EXPECT_EQ(regionIou({}, {b}), 0);
  EXPECT_EQ(regionIou({}, {}), 0);
}

TEST(MatchByOverlap, PairsByGreatestOverlapAndLeavesTheRest) {
  const std::vector<Polyline> observed{circle(0, 0, 10), circle(40, 0, 10), circle(100, 0, 10)};
  const std::vector<Polyline> predicted{circle(45, 0, 10), circle(1, 0, 10), circle(38, 0, 10), circle(200, 0, 10)};
  const auto pairs = matchByOverlap(observed, predicted);
  ASSERT_EQ(pairs.size(), 2u);
  EXPECT_EQ(pairs[0], (std::pair<int, int>(0, 1)));
  EXPECT_EQ(pairs[1], (std::pair<int, int>(1, 2)));  // 38 overlaps 40 more than 45 does
}

TEST(Statistic, InterpolatesBetweenOrderStatistics) {
  const Statistic s = statisticOf({4, std::nan(""), 1, 3, 2, 5});
  EXPECT_EQ(s.count, 5);
  EXPECT_DOUBLE_EQ(s.mean, 3);
  EXPECT_DOUBLE_EQ(s.median, 3);
  EXPECT_DOUBLE_EQ(s.p95, 4.8);  // position 0.95 * 4 = 3.8
  EXPECT_DOUBLE_EQ(s.max, 5);
  EXPECT_TRUE(std::isnan(statisticOf({}).mean));
}

}  // namespace
}  // namespace glint
