// SPDX-License-Identifier: BSD-3-Clause
#include "core/geometry/polyline.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/tolerances.h"

namespace glint {
namespace {
using tolerance::kExact;

const Polyline kRectangle{{{0, 0}, {4, 0}, {4, 3}, {0, 3}}, true};  // clockwise on screen: y is down
const Polyline kOpen{{{0, 0}, {4, 0}, {4, 3}}, false};

TEST(Polyline, LengthAreaCentroidOfARectangle) {
  EXPECT_DOUBLE_EQ(length(kRectangle), 14);
  EXPECT_DOUBLE_EQ(length(kOpen), 7);
  EXPECT_DOUBLE_EQ(signedArea(kRectangle), 12);
  EXPECT_DOUBLE_EQ(signedArea(Polyline{{{0, 3}, {4, 3}, {4, 0}, {0, 0}}, true}), -12);
  EXPECT_DOUBLE_EQ(signedArea(kOpen), 6);
  EXPECT_NEAR((centroid(kRectangle) - Pixel(2, 1.5)).norm(), 0, kExact);
}

TEST(Polyline, AreaFarAwayKeepsItsDigits) {
  Polyline moved = kRectangle;
  for (Pixel& p : moved.points) p += Pixel(1e8, -1e8);
  EXPECT_NEAR(signedArea(moved), 12, 1e-6);  // the moved corners themselves are rounded to 1e-8
  EXPECT_NEAR((centroid(moved) - Pixel(1e8 + 2, -1e8 + 1.5)).norm(), 0, 1e-6);
}

TEST(Polyline, CentroidOfAnAreaIsNotTheMeanOfItsPoints) {
  const Polyline crowded{{{0, 0}, {1, 0}, {2, 0}, {3, 0}, {4, 0}, {4, 3}, {0, 3}}, true};
  EXPECT_NEAR((centroid(crowded) - Pixel(2, 1.5)).norm(), 0, kExact);
  const Polyline flat{{{0, 0}, {2, 0}, {4, 0}}, true};
  EXPECT_NEAR((centroid(flat) - Pixel(2, 0)).norm(), 0, kExact);
  EXPECT_NEAR((centroid(Polyline{{{5, 6}}, true}) - Pixel(5, 6)).norm(), 0, kExact);
}

TEST(Polyline, ContainsByTheEvenOddRule) {
  EXPECT_TRUE(contains(kRectangle, {1, 1}));
  EXPECT_FALSE(contains(kRectangle, {5, 1}));
  EXPECT_FALSE(contains(kRectangle, {-1, 1}));
  EXPECT_FALSE(contains(Polyline{}, {0, 0}));
  const Polyline twice{{{0, 0}, {4, 0}, {4, 4}, {0, 4}, {0, 0}, {4, 0}, {4, 4}, {0, 4}}, true};
  EXPECT_FALSE(contains(twice, {2, 2}));  // enclosed twice is outside
}

TEST(Polyline, DistanceUsesTheClosingSegmentOnlyWhenClosed) {
  EXPECT_DOUBLE_EQ(distance(kRectangle, {-2, 1}), 2);
  EXPECT_DOUBLE_EQ(distance(kRectangle, {7, 7}), 5);
  EXPECT_DOUBLE_EQ(distance(kOpen, {0, 3}), 3);  // to (0, 0); the diagonal is not part of it
  EXPECT_DOUBLE_EQ(distance(Polyline{{{0, 0}, {4, 0}, {4, 3}}, true}, {0, 3}), 2.4);
  EXPECT_DOUBLE_EQ(distance(Polyline{{{1, 1}}, true}, {4, 5}), 5);
  EXPECT_TRUE(std::isinf(distance(Polyline{}, {0, 0})));
}

TEST(Polyline, ResampleIsEquallySpacedInArcLength) {
  const std::vector<Pixel> p = resample(kRectangle, 14);
  ASSERT_EQ(p.size(), 14u);
  EXPECT_NEAR((p[0] - Pixel(0, 0)).norm(), 0, kExact);
  EXPECT_NEAR((p[5] - Pixel(4, 1)).norm(), 0, kExact);
  EXPECT_NEAR((p[13] - Pixel(0, 1)).norm(), 0, kExact);
  const std::vector<Pixel> open = resample(kOpen, 8);
  EXPECT_NEAR((open[7] - Pixel(4, 3)).norm(), 0, kExact);
  EXPECT_THROW(resample(Polyline{}, 3), std::invalid_argument);
}

// A circle whose points crowd on one side: what is left are points of it, to the last bit, about as far from each other as they
// can be.
TEST(Polyline, ThinnedKeepsItsOwnPoints) {
  Polyline circle{{}, true};
  for (int i = 0; i < 200; ++i) {
    const double t = i < 100 ? i * 0.001 : 0.1 + (i - 100) * (2 * std::numbers::pi - 0.1) / 100;
    circle.points.emplace_back(5 * std::cos(t), 5 * std::sin(t));
  }
  const std::vector<Pixel> p = thinned(circle, 40);
  ASSERT_LE(p.size(), 40u);
  EXPECT_GE(p.size(), 38u);  // the nearest point of two places may be one
  auto from = circle.points.begin();
  for (std::size_t i = 0; i < p.size(); ++i) {
    from = std::find(from, circle.points.end(), p[i]);
    ASSERT_NE(from, circle.points.end()) << i;  // one of them, and in order
    ++from;
    const double gap = (p[(i + 1) % p.size()] - p[i]).norm();
    EXPECT_LE(gap, 10 * std::numbers::pi / 40 + 0.35) << i;  // a fortieth of the circle and half a gap at each end
  }
  EXPECT_EQ(thinned(kRectangle, 100), kRectangle.points);
  EXPECT_EQ(thinned(Polyline{{{0, 0}, {1, 0}, {2, 0}, {3, 0}, {4, 0}}, false}, 3), (std::vector<Pixel>{{0, 0}, {2, 0}, {4, 0}}));
  EXPECT_EQ(thinned(Polyline{{{2, 2}, {2, 2}, {2, 2}}, true}, 1).size(), 1u);
  EXPECT_THROW(thinned(Polyline{}, 3), std::invalid_argument);
}

TEST(Polyline, RepeatsAreRemovedAlsoAcrossTheEnd) {
  const Polyline p = withoutRepeats(Polyline{{{0, 0}, {0, 0}, {1, 0}, {1, 1}, {0, 0}}, true});
  EXPECT_EQ(p.points.size(), 3u);
  EXPECT_EQ(withoutRepeats(Polyline{{{0, 0}, {1, 0}, {0, 0}}, false}).points.size(), 3u);
}

TEST(Polyline, ReachIsTheFarthestCrossingOfAHalfLine) {
  Polyline square{{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}, true};
  EXPECT_NEAR(*reach(square, {0, 0}, 0), 1, 1e-12);
  EXPECT_NEAR(*reach(square, {0, 0}, std::atan2(0.5, 1)), std::hypot(0.5, 1), 1e-12);
  EXPECT_NEAR(*reach(square, {0, 0}, std::atan2(1, 1)), std::sqrt(2.0), 1e-12);  // through a vertex
  EXPECT_NEAR(*reach(square, {-3, 0.25}, 0), 4, 1e-12);                          // in and out again
  EXPECT_FALSE(reach(square, {3, 0}, 0));
  const Polyline diamond{{{1, 0}, {0, 1}, {-1, 0}, {0, -1}}, true};
  for (const double origin : {0.0, -0.5, -2.0})
    EXPECT_EQ(reach(diamond, {origin, 0}, 0), 1 - origin) << "a vertex lies exactly on the half line";
  EXPECT_FALSE(reach(diamond, {1.5, 0}, 0));
  square.closed = false;  // the left side is missing
  EXPECT_FALSE(reach(square, {0, 0}, std::acos(-1.0)));
}

}  // namespace
}  // namespace glint
