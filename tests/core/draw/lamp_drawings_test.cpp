// SPDX-License-Identifier: BSD-3-Clause
#include "core/draw/lamp_drawings.h"

#include <gtest/gtest.h>

#include <cmath>

namespace glint::draw {
namespace lamp_drawings_tests {

/// Two balls of 100 and 40 px, two photographs, the second without an answer.
BallLamps fit() {
  BallLamps f;
  for (const double radius : {100.0, 40.0}) {
    FittedBall& ball = f.balls.emplace_back();
    for (int k = 0; k < 90; ++k)
      ball.outline.emplace_back(200 + radius * std::cos(0.0698131700797732 * k), 150 + radius * std::sin(0.0698131700797732 * k));
  }
  LampAnswer& a = f.lamps.emplace_back();
  a.id = "lamp-a";
  a.frames = {"a"};
  a.outlineShare = 0.25;
  a.sightings.resize(2);
  a.sightings[1].ball = 1;
  a.sightings[0].peak = {210, 160};
  a.sightings[0].residualPx = {0.3, 0.4};
  a.sightings[1].peak = {190, 140};
  a.sightings[1].leftOutPx = Eigen::Vector2d(0, 2);
  a.dropped.push_back({"a", 1, {180, 130}, "smaller"});
  LampAnswer& b = f.lamps.emplace_back();
  b.id = "lamp-b";
  b.frames = {"b"};
  b.failure = Failure{Reason::NoHighlight, "dark"};
  return f;
}

TEST(BallOverlay, ArrowsLeadFromTheHighlightAlongItsResidual) {
  const BallLamps f = fit();
  BallOverlayInput in;
  in.fit = &f;
  in.lamp = &f.lamps[0];
  in.balls = {0, 1};
  in.corner = {100, 50};
  in.residualScale = 10;
  const FrameOverlay overlay = ballOverlay(in);
  int arrows = 0, outlines = 0;
  for (const OverlayLine& line : overlay.lines) {
    if (line.role != OverlayRole::ResidualArrows) {
      ++outlines;
      continue;
    }
    ++arrows;
    EXPECT_LT((line.points[0] - Pixel(110, 110)).norm(), 1e-12);
    EXPECT_LT((line.points[1] - Pixel(113, 114)).norm(), 1e-12);  // ten times (0.3, 0.4)
  }
  EXPECT_EQ(arrows, 1);  // the other residual is 0
  EXPECT_EQ(outlines, 2);
  EXPECT_EQ(overlay.marks.size(), 3U);  // two highlights and a dropped one
  in.balls = {1};                       // a cut-out that shows the second ball alone
  EXPECT_EQ(ballOverlay(in).marks.size(), 2U);
}

TEST(BallOverlay, WhatAPersonDrewIsThereBeforeAnythingIsMeasured) {
  BallOverlayInput in;
  in.drawn = {{{300, 200}, 50}};
  in.rim = {{1, 2}};
  const FrameOverlay overlay = ballOverlay(in);
  ASSERT_EQ(overlay.lines.size(), 1U);
  EXPECT_EQ(overlay.lines[0].dash, Dash::Dashed);
  for (const Pixel& p : overlay.lines[0].points) EXPECT_NEAR((p - Pixel(300, 200)).norm(), 50, 1e-9);
  EXPECT_EQ(overlay.marks.size(), 2U);
}

// An eighth of 40 px is 5, eleven times the longest residual of 0.45.
TEST(BallResidualScale, KeepsArrowsShort) {
  BallLamps f = fit();
  f.lamps[0].sightings[0].residualPx = {0.27, 0.36};
  EXPECT_EQ(ballResidualScale(f.balls, f.lamps), 10);
  f.lamps[0].sightings[0].residualPx = {0, 7};
  EXPECT_EQ(ballResidualScale(f.balls, f.lamps), 1);
  f.lamps[0].sightings[0].residualPx = {0, 1e-9};
  EXPECT_EQ(ballResidualScale(f.balls, f.lamps), 100);
  f.lamps[0].sightings[0].residualPx = {0, 0};
  EXPECT_EQ(ballResidualScale(f.balls, f.lamps), 1);
}

TEST(BallResidualPlot, HasABarForEveryHighlightAndACrossWithoutAnswer) {
  const BallLamps f = fit();
  const PlotData plot = ballResidualPlot(f.lamps, 2);
  EXPECT_EQ(plot.empty, "");
  ASSERT_EQ(plot.series.size(), 3U);  // two balls, and one that the other predicts
  EXPECT_NEAR(plot.series[0].points[0].y, 0.5, 1e-12);
  EXPECT_TRUE(plot.series[0].points[1].noValue);
  EXPECT_EQ(plot.series[0].points[1].target.frame, 1);
  EXPECT_EQ(plot.series[2].points[0].y, 2);
  EXPECT_LT(plot.series[0].points[0].x, plot.series[1].points[0].x);
  EXPECT_NE(ballResidualPlot(f.lamps, 1).empty, "");
  EXPECT_NE(ballResidualPlot({}, 2).empty, "");
}

TEST(OutlineSharePlot, IsInPercent) {
  BallLamps f = fit();
  const PlotData plot = outlineSharePlot(f.lamps);
  EXPECT_EQ(plot.empty, "");
  EXPECT_EQ(plot.series[0].points[0].y, 25);
  EXPECT_TRUE(plot.series[0].points[1].noValue);
  f.lamps[0].outlineShare = 0;
  EXPECT_NE(outlineSharePlot(f.lamps).empty, "");
}

}  // namespace lamp_drawings_tests
}  // namespace glint::draw
