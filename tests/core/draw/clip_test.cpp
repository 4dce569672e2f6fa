// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "core/draw/painter.h"

namespace glint::draw {
namespace {

using Points = std::vector<Eigen::Vector2d>;
constexpr Box kBox{0, 0, 10, 10};

TEST(ChainsInside, WhatIsInsideStaysAndWhatIsOutsideGoes) {
  const std::vector<Chain> in = chainsInside({{1, 1}, {9, 1}, {5, 9}}, true, kBox);
  ASSERT_EQ(in.size(), 1u);
  EXPECT_TRUE(in[0].closed);
  EXPECT_EQ(in[0].points.size(), 3u);
  EXPECT_TRUE(chainsInside({{11, 1}, {20, 1}, {15, 9}}, true, kBox).empty());
}

TEST(ChainsInside, ALineIsCutAtTheBorderAlsoWhereNoVertexIsInside) {
  const std::vector<Chain> cut = chainsInside({{-5, 5}, {15, 7}}, false, kBox);
  ASSERT_EQ(cut.size(), 1u);
  EXPECT_NEAR((cut[0].points.front() - Eigen::Vector2d(0, 5.5)).norm(), 0, 1e-12);
  EXPECT_NEAR((cut[0].points.back() - Eigen::Vector2d(10, 6.5)).norm(), 0, 1e-12);
}

TEST(ChainsInside, APathThatLeavesAndComesBackIsTwoPieces) {
  // Beside the box and back over a vertex outside, and along a whole stretch outside.
  for (const Points& path : {Points{{5, 2}, {15, 5}, {5, 8}}, Points{{5, 2}, {15, 2}, {20, 5}, {15, 8}, {5, 8}}}) {
    const std::vector<Chain> cut = chainsInside(path, false, kBox);
    ASSERT_EQ(cut.size(), 2u);
    EXPECT_EQ(cut[0].points.front(), Eigen::Vector2d(5, 2));
    EXPECT_NEAR(cut[0].points.back().x(), 10, 1e-12);
    EXPECT_NEAR(cut[1].points.front().x(), 10, 1e-12);
    EXPECT_EQ(cut[1].points.back(), Eigen::Vector2d(5, 8));
  }
}

TEST(ChainsInside, OfAClosedLineTheLastStretchCountsToo) {
  const Points path{{-5, 5}, {-5, -9}, {15, -9}, {15, 5}};
  const std::vector<Chain> cut = chainsInside(path, true, kBox);  // only its closing one is inside
  ASSERT_EQ(cut.size(), 1u);
  EXPECT_EQ(cut[0].points, (Points{{10, 5}, {0, 5}}));
  EXPECT_TRUE(chainsInside(path, false, kBox).empty());
}

TEST(ChainsInside, LevelAndUprightLinesBesideTheBoxGo) {
  for (const double beside : {-1.0, 11.0}) {
    EXPECT_TRUE(chainsInside({{2, beside}, {8, beside}}, false, kBox).empty());
    EXPECT_TRUE(chainsInside({{beside, 2}, {beside, 8}}, false, kBox).empty());
  }
  EXPECT_EQ(chainsInside({{-3, 5}, {13, 5}}, false, kBox).at(0).points, (Points{{0, 5}, {10, 5}}));
}

TEST(ChainsInside, ACircleOverACornerKeepsItsArcInside) {
  Points circle;
  for (int i = 0; i < 3600; ++i)
    circle.push_back(4 * Eigen::Vector2d(std::cos(i * std::numbers::pi / 1800), std::sin(i * std::numbers::pi / 1800)));
  double length = 0;
  for (const Chain& piece : chainsInside(circle, true, kBox)) {
    EXPECT_FALSE(piece.closed);
    for (std::size_t i = 0; i < piece.points.size(); ++i) {
      EXPECT_GE(piece.points[i].minCoeff(), -1e-12);
      if (i > 0) length += (piece.points[i] - piece.points[i - 1]).norm();
    }
  }
  EXPECT_NEAR(length, 4 * std::numbers::pi / 2, 1e-5);  // a quarter of it
}

TEST(ChainsInside, WithoutABoxNothingIsCutAndWhatIsNotFiniteIsLeftOut) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<Chain> all = chainsInside({{-1e6, 0}, {nan, 3}, {1e6, 4}}, false, {});
  ASSERT_EQ(all.size(), 1u);
  EXPECT_EQ(all[0].points, (Points{{-1e6, 0}, {1e6, 4}}));
  EXPECT_TRUE(chainsInside({{1, 1}, {nan, 1}}, false, kBox).empty()) << "one point is no line";
  EXPECT_TRUE(chainsInside({}, true, kBox).empty());
}

}  // namespace
}  // namespace glint::draw
