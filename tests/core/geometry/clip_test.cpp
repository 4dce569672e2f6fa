// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/geometry/polyline.h"
#include "tests/tolerances.h"

namespace glint::clip_tests {
namespace {

const Eigen::AlignedBox2d kBox(Pixel(0, 0), Pixel(10, 6));

Polyline disc(const Pixel& centre, double radius, int points = 7200) {
  Polyline circle{{}, true};
  for (int i = 0; i < points; ++i)
    circle.points.push_back(centre + radius * Pixel(std::cos(2 * M_PI * i / points), std::sin(2 * M_PI * i / points)));
  return circle;
}

double areaOf(const Polyline& line) { return std::abs(signedArea(line)); }

TEST(ClippedTo, CutsADiscToItsSegments) {
  // Half of it beyond the left edge; and the segment of height h = r / 2 beyond it: r^2 (acos((r - h) / r)) - (r - h) sqrt(2 r h
  // - h^2).
  EXPECT_NEAR(areaOf(clippedTo(kBox, disc({0, 3}, 2))), M_PI * 2, 1e-5);  // 7200 chords: r^2 pi (2 pi / 7200)^2 / 6
  const double lost = 4 * std::acos(0.5) - std::sqrt(3.0);
  EXPECT_NEAR(areaOf(clippedTo(kBox, disc({1, 3}, 2))), M_PI * 4 - lost, 1e-5);
  EXPECT_NEAR(areaOf(clippedTo(kBox, disc({0, 0}, 2))), M_PI, 1e-5);  // the corner
}

TEST(ClippedTo, EveryScale) {
  for (const double scale : {1e-9, 1e-3, 1e3, 1e9}) {
    Polyline small = disc({0, 3}, 2);
    for (Pixel& p : small.points) p *= scale;
    const Eigen::AlignedBox2d box(kBox.min() * scale, kBox.max() * scale);
    EXPECT_NEAR(areaOf(clippedTo(box, small)) / (scale * scale), M_PI * 2, 1e-5) << scale;
  }
}

/// Random stars, some of which cross themselves: a point is inside of the part where it is inside of both (even-odd).
TEST(ClippedTo, InsideIsInsideOfBoth) {
  std::mt19937_64 rng(20);
  std::uniform_real_distribution<double> x(-6, 16), y(-6, 12);
  int inside = 0;
  for (int shape = 0; shape < 200; ++shape) {
    Polyline line{{}, true};
    for (int i = 0; i < 9; ++i) line.points.emplace_back(x(rng), y(rng));
    const Polyline part = clippedTo(kBox, line);
    for (const Pixel& p : part.points) {
      EXPECT_TRUE(kBox.contains(p)) << shape << ": " << p.transpose();
    }
    for (int i = 0; i < 100; ++i) {
      const Pixel q(x(rng), y(rng));
      const bool both = kBox.contains(q) && contains(line, q);
      inside += both;
      EXPECT_EQ(!part.points.empty() && contains(part, q), both) << shape << ": " << q.transpose();
    }
  }
  EXPECT_GT(inside, 1000);  // both answers come up
}

TEST(ClippedTo, WhatDoesNotMeetTheBoxIsEmptyAndWhatLiesInItStays) {
  EXPECT_TRUE(clippedTo(kBox, disc({-5, 3}, 2)).points.empty());
  EXPECT_TRUE(clippedTo(kBox, {}).points.empty());
  EXPECT_TRUE(clippedTo(kBox, {{{1, 1}, {2, 2}}, true}).points.empty());
  const Polyline whole = disc({5, 3}, 2, 12);
  EXPECT_EQ(clippedTo(kBox, whole).points, whole.points);
  EXPECT_NEAR(areaOf(clippedTo(kBox, disc({5, 3}, 100))), 60, tolerance::kExact);  // the box itself
  // A comb leaves and comes back twice: three teeth of 1 x 2 stay, joined along the edge.
  const Polyline comb{{{1, 4}, {2, 4}, {2, 8}, {3, 8}, {3, 4}, {4, 4}, {4, 8}, {5, 8}, {5, 4}, {6, 4}, {6, 9}, {1, 9}}, true};
  EXPECT_NEAR(areaOf(clippedTo(kBox, comb)), 6, tolerance::kExact);
}

}  // namespace
}  // namespace glint::clip_tests
