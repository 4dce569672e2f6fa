// SPDX-License-Identifier: BSD-3-Clause
#include "viz/overlay_clip.h"

#include <gtest/gtest.h>

#include <cmath>

namespace glint::viz {
namespace {

const Eigen::AlignedBox2d kBox(Eigen::Vector2d(0, 0), Eigen::Vector2d(10, 10));

FrameOverlay lineOf(std::vector<Pixel> points, bool closed) {
  FrameOverlay overlay;
  OverlayLine line;
  line.points = std::move(points);
  line.closed = closed;
  overlay.lines = {line};
  return overlay;
}

TEST(CutTo, WhatIsInsideStaysAndWhatIsOutsideGoes) {
  const FrameOverlay in = cutTo(lineOf({{1, 1}, {9, 1}, {5, 9}}, true), kBox);
  ASSERT_EQ(in.lines.size(), 1u);
  EXPECT_TRUE(in.lines[0].closed);
  EXPECT_EQ(in.lines[0].points.size(), 3u);
  EXPECT_TRUE(cutTo(lineOf({{11, 1}, {20, 1}, {15, 9}}, true), kBox).lines.empty());
}

TEST(CutTo, ALineIsCutAtTheBorderAlsoWhereNoVertexIsInside) {
  const FrameOverlay cut = cutTo(lineOf({{-5, 5}, {15, 7}}, false), kBox);
  ASSERT_EQ(cut.lines.size(), 1u);
  EXPECT_NEAR((cut.lines[0].points.front() - Pixel(0, 5.5)).norm(), 0, 1e-12);
  EXPECT_NEAR((cut.lines[0].points.back() - Pixel(10, 6.5)).norm(), 0, 1e-12);
}

TEST(CutTo, APathThatLeavesAndComesBackIsTwoPieces) {
  // Beside the box and back over a vertex outside, and along a whole stretch outside.
  for (const std::vector<Pixel>& path :
       {std::vector<Pixel>{{5, 2}, {15, 5}, {5, 8}}, {{5, 2}, {15, 2}, {20, 5}, {15, 8}, {5, 8}}}) {
    const FrameOverlay cut = cutTo(lineOf(path, false), kBox);
    ASSERT_EQ(cut.lines.size(), 2u);
    EXPECT_EQ(cut.lines[0].points.front(), Pixel(5, 2));
    EXPECT_NEAR(cut.lines[0].points.back().x(), 10, 1e-12);
    EXPECT_NEAR(cut.lines[1].points.front().x(), 10, 1e-12);
    EXPECT_EQ(cut.lines[1].points.back(), Pixel(5, 8));
  }
}

TEST(CutTo, OfAClosedLineTheLastStretchCountsToo) {
  const FrameOverlay cut = cutTo(lineOf({{-5, 5}, {-5, -9}, {15, -9}, {15, 5}}, true), kBox);  // only its closing one is inside
  ASSERT_EQ(cut.lines.size(), 1u);
  EXPECT_EQ(cut.lines[0].points, (std::vector<Pixel>{{10, 5}, {0, 5}}));
  EXPECT_TRUE(cutTo(lineOf({{-5, 5}, {-5, -9}, {15, -9}, {15, 5}}, false), kBox).lines.empty());
}

TEST(CutTo, LevelAndUprightLinesBesideTheBoxGo) {
  for (const double beside : {-1.0, 11.0}) {
    EXPECT_TRUE(cutTo(lineOf({{2, beside}, {8, beside}}, false), kBox).lines.empty());
    EXPECT_TRUE(cutTo(lineOf({{beside, 2}, {beside, 8}}, false), kBox).lines.empty());
  }
  EXPECT_EQ(cutTo(lineOf({{-3, 5}, {13, 5}}, false), kBox).lines.at(0).points, (std::vector<Pixel>{{0, 5}, {10, 5}}));
}

TEST(CutTo, ACircleOverACornerKeepsItsArcInside) {
  std::vector<Pixel> circle;
  for (int i = 0; i < 3600; ++i) circle.push_back(4 * Pixel(std::cos(i * M_PI / 1800), std::sin(i * M_PI / 1800)));
  double length = 0;
  for (const OverlayLine& piece : cutTo(lineOf(circle, true), kBox).lines) {
    EXPECT_FALSE(piece.closed);
    for (std::size_t i = 0; i < piece.points.size(); ++i) {
      EXPECT_GE(piece.points[i].minCoeff(), -1e-12);
      if (i > 0) length += (piece.points[i] - piece.points[i - 1]).norm();
    }
  }
  EXPECT_NEAR(length, 4 * M_PI / 2, 1e-5);  // a quarter of it
}

TEST(CutTo, MarksAreInOrOut) {
  FrameOverlay overlay;
  overlay.marks.resize(2);
  overlay.marks[0].at = {5, 5};
  overlay.marks[1].at = {5, 11};
  EXPECT_EQ(cutTo(overlay, kBox).marks.size(), 1u);
}

}  // namespace
}  // namespace glint::viz
