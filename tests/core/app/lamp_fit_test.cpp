// SPDX-License-Identifier: BSD-3-Clause
#include "core/app/lamp_fit.h"

#include <gmock/gmock.h>

#include "tests/core/app/ball_scene.h"

namespace glint::lamp_fit_tests {
using namespace ball_scene;
using testing::HasSubstr;

constexpr double kExact = 1e-6;  // rad, and of the distance: the bar for exact data

TEST(BallLamps, Nominal) {
  const Arrangement a;
  const auto fit = fitBallLamps(a.photographs());
  ASSERT_TRUE(fit) << fit.failure().message();
  ASSERT_EQ(fit->lamps.size(), a.lamps.size());
  const Eigen::Vector3d middle = (a.balls[0] + a.balls[1]) / 2;
  for (std::size_t i = 0; i < a.lamps.size(); ++i) {
    const LampAnswer& lamp = fit->lamps[i];
    ASSERT_FALSE(lamp.failure) << lamp.failure->message();
    ASSERT_TRUE(lamp.position) << lamp.withoutPosition;
    const Eigen::Vector3d truth = a.lamps[i].at;
    EXPECT_LT((*lamp.position - truth).norm(), kExact * (truth - middle).norm());
    EXPECT_LT((*lamp.from - middle).norm(), kExact);
    EXPECT_LT(lamp.direction.cross((truth - middle).normalized()).norm(), kExact);
    EXPECT_EQ(lamp.highlights, 2);
    EXPECT_LT(lamp.residualPx, kExact);
  }
  EXPECT_EQ(fit->degreesOfFreedom, 4);
}

// One ball leaves the distance open: a distant lamp's direction is exact, and the answer says what it is.
TEST(BallLamps, OneBallGivesADirection) {
  Arrangement a;
  a.balls.resize(1);
  const Eigen::Vector3d direction = Eigen::Vector3d(0.3, -0.7, -0.5).normalized();
  a.lamps = {{direction, true}};
  const auto fit = fitBallLamps(a.photographs());
  ASSERT_TRUE(fit);
  EXPECT_FALSE(fit->lamps[0].position);
  EXPECT_THAT(fit->lamps[0].withoutPosition, HasSubstr("leaves the distance open"));
  EXPECT_LT((fit->lamps[0].direction - direction).norm(), kExact);
  EXPECT_LT((*fit->lamps[0].from - a.balls[0]).norm(), kExact);
}

TEST(BallLamps, ParallelRaysGiveADirection) {
  Arrangement a;
  const Eigen::Vector3d direction = Eigen::Vector3d(-0.2, -0.9, -0.3).normalized();
  a.lamps = {{direction, true}, {1e5 * direction}};
  const auto fit = fitBallLamps(a.photographs());
  ASSERT_TRUE(fit);
  for (const LampAnswer& lamp : fit->lamps) {
    EXPECT_FALSE(lamp.position);
    EXPECT_THAT(lamp.withoutPosition, HasSubstr("parallel rays"));
  }
  EXPECT_LT((fit->lamps[0].direction - direction).norm(), kExact);
}

TEST(BallLamps, WithoutAFocalLength) {
  BallPhotographs p;
  RefinedOutline o;
  o.outline = {{431.7, 380.2}, 211.4};
  o.covariance = 0.01 * Eigen::Matrix3d::Identity();
  p.balls = {o};
  const Eigen::Vector3d direction = Eigen::Vector3d(0.6, 0.35, -0.55).normalized();
  const Eigen::Vector3d at = mirrorPoint({431.7, 380.2, 0}, 211.4, {{0, 0, -1}, true}, {direction, true});
  p.seen = {seenOn(0, "a", at.head<2>(), 0.2)};
  const auto fit = fitBallLamps(p);
  ASSERT_TRUE(fit);
  EXPECT_LT((fit->lamps[0].direction - direction).norm(), kExact);
  EXPECT_FALSE(fit->lamps[0].from);
  EXPECT_FALSE(fit->lamps[0].position);
  EXPECT_THAT(fit->lamps[0].withoutPosition, HasSubstr("without a focal length"));
}

// Cut-outs whose places in the shot nobody states stand in one place: the peaks' noise is no parallax.
TEST(BallLamps, CutOutsInOnePlaceGiveADirection) {
  BallPhotographs p;
  RefinedOutline o;
  o.outline = {{70.2, 70.1}, 50};
  o.covariance = 0.01 * Eigen::Matrix3d::Identity();
  p.balls = {o, o};
  const Eigen::Vector3d direction = Eigen::Vector3d(0.6, 0.35, -0.55).normalized();
  const Eigen::Vector2d at = mirrorPoint({70.2, 70.1, 0}, 50, {{0, 0, -1}, true}, {direction, true}).head<2>();
  p.seen = {seenOn(0, "a", at + Eigen::Vector2d(0.04, -0.03), 0.05), seenOn(1, "a", at - Eigen::Vector2d(0.04, -0.03), 0.05)};
  for (const bool outlinesToo : {true, false}) {
    const auto fit = fitBallLamps(p, outlinesToo);
    ASSERT_TRUE(fit);
    ASSERT_FALSE(fit->lamps[0].failure) << fit->lamps[0].failure->message();
    constexpr double kPeaks = 0.05 * 2 / 50;  // rad: by the peaks' distance from their mean; 10 degrees before
    EXPECT_LT((fit->lamps[0].direction - direction).norm(), kPeaks);
  }
}

// A near lamp before two balls and a distant camera: the directions differ along the line between the balls, and not across it.
TEST(BallLamps, ParallaxWithoutAFocalLength) {
  BallPhotographs p;
  const std::vector<Eigen::Vector3d> centres{{500, 900, 0}, {2500, 900, 0}};
  const Eigen::Vector3d lamp(1500, -3000, -6000);
  for (std::size_t k = 0; k < 2; ++k) {
    RefinedOutline o;
    o.outline = {centres[k].head<2>(), 400};
    o.covariance = 0.01 * Eigen::Matrix3d::Identity();
    p.balls.push_back(o);
    p.seen.push_back(seenOn(k, "a", mirrorPoint(centres[k], 400, {{0, 0, -1}, true}, {lamp}).head<2>(), 0.2));
  }
  const auto fit = fitBallLamps(p);
  ASSERT_TRUE(fit);
  ASSERT_TRUE(fit->lamps[0].parallax);
  // Seen from the middle of the two mirror points, which are as high and as near; half the angle is atan(half the distance over
  // the lamp's).
  EXPECT_NEAR(fit->lamps[0].parallax->acrossDeg, 0, 1e-6);
  EXPECT_LT(fit->lamps[0].parallax->alongDeg, -10);
  EXPECT_LT((fit->lamps[0].direction - (lamp - Eigen::Vector3d(1500, 900, 0)).normalized()).norm(), kExact);
}

TEST(BallLamps, Scale) {
  for (const double scale : {1e-3, 1e3}) {
    Arrangement a;
    a.radius *= scale;
    for (Eigen::Vector3d& b : a.balls) b *= scale;
    for (Target& l : a.lamps) l.at *= scale;
    const auto fit = fitBallLamps(a.photographs());
    ASSERT_TRUE(fit);
    for (std::size_t i = 0; i < a.lamps.size(); ++i) {
      ASSERT_TRUE(fit->lamps[i].position);
      EXPECT_LT((*fit->lamps[i].position - a.lamps[i].at).norm(), kExact * a.lamps[i].at.norm() + kExact * scale);
    }
  }
}

TEST(BallLamps, LengthsAreInRadiiWithoutOne) {
  const Arrangement a;
  BallPhotographs p = a.photographs();
  p.ballRadius.reset();
  const auto fit = fitBallLamps(p);
  ASSERT_TRUE(fit);
  EXPECT_LT((*fit->lamps[0].position * a.radius - a.lamps[0].at).norm(), kExact);
}

// The squared error over its covariance has mean 3 and variance 6 for a position: over 200 x 4 of them the mean lies within 3 +-
// 0.26 with near certainty.
TEST(BallLamps, NoiseHasThePromisedSpread) {
  Arrangement a;
  a.peakPx = 0.1;
  a.edgePx = 1.5;  // 0.2 px of the outline: both kinds of noise count
  double sum = 0, directions = 0, variances = 0;
  int count = 0;
  const Eigen::Vector3d middle = (a.balls[0] + a.balls[1]) / 2;
  for (unsigned seed = 1; seed <= 200; ++seed) {
    const auto fit = fitBallLamps(a.noisy(seed));
    ASSERT_TRUE(fit);
    for (std::size_t i = 0; i < a.lamps.size(); ++i) {
      const LampAnswer& lamp = fit->lamps[i];
      ASSERT_TRUE(lamp.position);
      const Eigen::Vector3d off = *lamp.position - a.lamps[i].at;
      sum += off.dot(lamp.covariance->inverse() * off) * std::pow(fit->noiseFactor, 2);
      directions += lamp.direction.cross((a.lamps[i].at - middle).normalized()).squaredNorm();
      variances += std::pow(lamp.directionSigma / fit->noiseFactor, 2);
      ++count;
    }
  }
  EXPECT_NEAR(sum / count, 3, 0.3);
  EXPECT_NEAR(directions / variances, 1, 0.15);
}

// Residuals larger than promised widen all covariances.
TEST(BallLamps, UnderstatedNoiseIsSeen) {
  Arrangement a;
  a.peakPx = 0.5;
  for (int i = 0; i < 30; ++i) a.lamps.push_back({{std::cos(0.2 * i), std::sin(0.2 * i) - 0.5, 0.1}});
  BallPhotographs p = a.noisy(7);
  for (LampObservation& o : p.seen) o.covariance /= 25;
  const auto fit = fitBallLamps(p);
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->noiseFactor, 5, 1.5);  // of 34 degrees of freedom: a spread of an eighth, and some goes into the outlines
}

TEST(BallLamps, HighlightsRefineAnOutlineThatIsKnownPoorly) {
  Arrangement a;
  for (int i = 0; i < 12; ++i) a.lamps.push_back({{1.2 * std::cos(0.5 * i), 1.2 * std::sin(0.5 * i) - 0.3, 0.1 * i - 0.5}});
  BallPhotographs p = a.photographs();
  for (EdgePoint& e : p.balls[1].edge) e.place.y() += 2;
  p.balls[1].outline.centre.y() += 2;
  p.balls[1].covariance *= std::pow(2 / 0.1, 2) * 60;  // 2 px of each number
  const auto with = fitBallLamps(p), without = fitBallLamps(p, false);
  ASSERT_TRUE(with && without);
  EXPECT_NEAR(with->balls[1].shiftPx.y(), -2, 0.2);
  double better = 0, worse = 0;
  const Eigen::Vector3d middle = (a.balls[0] + a.balls[1]) / 2;
  for (std::size_t i = 0; i < a.lamps.size(); ++i) {
    better += with->lamps[i].direction.cross((a.lamps[i].at - middle).normalized()).norm();
    worse += without->lamps[i].direction.cross((a.lamps[i].at - middle).normalized()).norm();
  }
  EXPECT_LT(better, 0.3 * worse);
}

TEST(BallLamps, OfThreeBallsTheWrongOneIsNamed) {
  Arrangement a;
  a.balls.emplace_back(0.0, 0.4, 1.4);
  BallPhotographs p = a.photographs();
  p.seen[4].peak += Pixel(14, -9);  // the second shot, on the second ball
  const auto fit = fitBallLamps(p);
  ASSERT_TRUE(fit);
  const LampAnswer& lamp = fit->lamps[1];
  ASSERT_EQ(lamp.dropped.size(), 1U);
  EXPECT_EQ(lamp.dropped[0].ball, 1U);
  EXPECT_EQ(lamp.dropped[0].frame, "shot1");
  EXPECT_THAT(lamp.dropped[0].reason, HasSubstr("contradicts"));
  EXPECT_EQ(lamp.highlights, 2);
  ASSERT_TRUE(lamp.position);
  EXPECT_LT((*lamp.position - a.lamps[1].at).norm(), kExact);
  for (const std::size_t other : {0U, 2U, 3U}) EXPECT_TRUE(fit->lamps[other].dropped.empty());
}

TEST(BallLamps, TwoBallsThatContradictEachOtherAreNoAnswer) {
  const Arrangement a;
  BallPhotographs p = a.photographs();
  p.seen[2].peak += Pixel(2, 15);
  const auto fit = fitBallLamps(p);
  ASSERT_TRUE(fit);
  ASSERT_TRUE(fit->lamps[1].failure);
  EXPECT_THAT(fit->lamps[1].failure->detail, HasSubstr("contradict"));
  EXPECT_EQ(fit->lamps[1].dropped.size(), 2U);
  EXPECT_FALSE(fit->lamps[0].failure);
}

TEST(BallLamps, AnotherBrightPlaceThatAgreesIsTaken) {
  const Arrangement a;
  BallPhotographs p = a.photographs();
  const Pixel right = p.seen[2].peak;
  p.seen[2].peak += Pixel(2, 15);
  p.seen[2].dropped = {{right, "smaller than the largest"}, {right + Pixel(-12, -20), "smaller than the largest"}};
  const auto fit = fitBallLamps(p);
  ASSERT_TRUE(fit);
  const LampAnswer& lamp = fit->lamps[1];
  ASSERT_FALSE(lamp.failure);
  ASSERT_TRUE(lamp.position);
  EXPECT_LT((*lamp.position - a.lamps[1].at).norm(), kExact);
  EXPECT_THAT(lamp.dropped.back().reason, HasSubstr("another bright place"));
}

TEST(BallLamps, DegenerateInputsAreNamed) {
  EXPECT_EQ(fitBallLamps({}).failure().reason, Reason::TooFewPoints);
  Arrangement a;
  BallPhotographs p = a.photographs();
  p.seen.clear();
  EXPECT_EQ(fitBallLamps(p).failure().reason, Reason::TooFewPoints);
  p = a.photographs();
  p.seen.resize(2);
  p.seen[0].peak = {5, 5};
  p.seen[1].peak = {std::nan(""), 5};
  const auto fit = fitBallLamps(p);
  ASSERT_TRUE(fit);
  ASSERT_TRUE(fit->lamps[0].failure);
  EXPECT_EQ(fit->lamps[0].failure->reason, Reason::PeakOffSurface);
  EXPECT_EQ(fit->lamps[0].dropped.size(), 2U);
}

// Left-out predictions: exact data predict the other ball's peak up to what the open distance leaves.
TEST(BallLamps, ADistantLampIsPredictedFromTheOtherBall) {
  Arrangement a;
  a.lamps = {{Eigen::Vector3d(0.1, -0.8, -0.6), true}, {Eigen::Vector3d(0.7, -0.2, -0.6), true}};
  const auto fit = fitBallLamps(a.photographs());
  ASSERT_TRUE(fit);
  for (const LampSighting& s : fit->lamps[0].sightings) {
    ASSERT_TRUE(s.leftOutPx);
    EXPECT_LT(s.leftOutPx->norm(), 1e-5);
  }
}

}  // namespace glint::lamp_fit_tests
