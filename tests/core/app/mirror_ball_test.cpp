// SPDX-License-Identifier: BSD-3-Clause
#include "core/app/mirror_ball.h"

#include <gtest/gtest.h>

#include <array>
#include <random>

#include "core/app/ball_outline.h"
#include "tests/core/app/ball_scene.h"

namespace glint::mirror_ball_tests {
using namespace ball_scene;

constexpr double kPixel = 1e-9;  // of coordinates up to 2000 px: a hundred ulp

TEST(MirrorPixel, Nominal) {
  const BallProjection view{camera()};
  const MirrorBall ball{{-4, 1, 20}, 1};
  for (const Eigen::Vector3d& at : {Eigen::Vector3d(3, -8, 5), Eigen::Vector3d(-5, 0.5, 18), Eigen::Vector3d(-4.5, 2, -30)}) {
    const Eigen::Vector3d from = at - ball.centre;
    const AimedLamp lamp{from.normalized(), 1 / from.norm(), ball.centre};
    const auto found = mirrorPixel(view, ball, lamp);
    ASSERT_TRUE(found);
    EXPECT_LT((*found - seenBy(camera(), mirrorPoint(ball.centre, 1, {}, {at}))).norm(), kPixel);
  }
}

TEST(MirrorPixel, DistantLampAndDistantCamera) {
  const MirrorBall ball{{300, 200, 0}, 100};
  const Eigen::Vector3d direction = Eigen::Vector3d(0.5, -0.6, -0.4).normalized();
  const auto found = mirrorPixel(BallProjection{}, ball, {direction, 0, {}});
  ASSERT_TRUE(found);
  const Eigen::Vector3d p = mirrorPoint(ball.centre, 100, {{0, 0, -1}, true}, {direction, true});
  EXPECT_LT((*found - p.head<2>()).norm(), kPixel);
  // The normal halves the angle between camera and lamp.
  const Eigen::Vector3d n = (direction - Eigen::Vector3d::UnitZ()).normalized();
  EXPECT_LT((*found - Pixel(300 + 100 * n.x(), 200 + 100 * n.y())).norm(), kPixel);
}

TEST(MirrorPixel, BehindTheBallIsNotSeen) {
  const MirrorBall ball{{0, 0, 20}, 1};
  EXPECT_FALSE(mirrorPixel(BallProjection{camera()}, ball, {Eigen::Vector3d(0.01, 0, 1).normalized(), 1e-3, ball.centre}));
}

// A mirror shows the way back: the ray of the pixel that mirrorPixel() gives meets the lamp.
TEST(MirrorRay, MeetsTheLamp) {
  const BallProjection view{camera()};
  const MirrorBall ball{{-4, 1, 20}, 1};
  const Eigen::Vector3d at(3, -8, 5);
  const auto ray = mirrorRay(view, ball, seenBy(camera(), mirrorPoint(ball.centre, 1, {}, {at})));
  ASSERT_TRUE(ray);
  EXPECT_LT((at - ray->origin).normalized().cross(ray->direction).norm(), 1e-11);
  EXPECT_GT(ray->direction.dot(at - ray->origin), 0);
}

TEST(MirrorRay, OutsideOfTheOutlineIsRefused) {
  const auto ray = mirrorRay(BallProjection{}, {{100, 100, 0}, 50}, {151, 100});
  ASSERT_FALSE(ray);
  EXPECT_EQ(ray.failure().reason, Reason::PeakOffSurface);
}

// An exact outline far from the axis is an ellipse whose centre is not the ball's; a circle through it would be 1.5 px off.
TEST(BallParameters, ConeOfTheOutline) {
  for (const double scale : {1e-3, 1.0, 1e3}) {
    const Eigen::Vector3d centre = scale * Eigen::Vector3d(-0.4, 0.25, 1.3);
    const auto b = ballParameters(BallProjection{camera()}, outlineOf(camera(), centre, 0.05 * scale, 0.1));
    ASSERT_TRUE(b);
    EXPECT_LT((ballOf(BallProjection{camera()}, b->value).centre * 0.05 * scale - centre).norm(), 1e-9 * centre.norm());
  }
}

TEST(BallParameters, NoBallHasAHugeOutline) {
  RefinedOutline o;
  o.outline = {{959.5, 539.5}, 1e7};
  o.covariance.setIdentity();
  EXPECT_FALSE(ballParameters(BallProjection{camera()}, o));
  o.outline.radius = std::nan("");
  EXPECT_FALSE(ballParameters(BallProjection{}, o));
}

TEST(LampOfRays, MeetingPointAndInfinity) {
  const Eigen::Vector3d at(2, 3, -4);
  std::vector<MirrorRay> rays;
  for (const Eigen::Vector3d& from : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(5, 0, 1)})
    rays.push_back({from, (at - from).normalized()});
  const AimedLamp near = lampOfRays(rays, {1, 1, 1}, 5);
  EXPECT_LT((near.reference + near.direction / near.inverseDistance - at).norm(), 1e-12);
  for (MirrorRay& r : rays) r.direction = Eigen::Vector3d(0.6, 0, -0.8);
  const AimedLamp far = lampOfRays(rays, {1, 1, 1}, 5);
  EXPECT_LT(std::abs(far.inverseDistance), 1e-15);
  EXPECT_LT((far.direction - Eigen::Vector3d(0.6, 0, -0.8)).norm(), 1e-14);
}

// On the axis the outline is a circle of radius f tan(asin(1 / distance)).
TEST(OutlinePixels, OnTheAxisAndBesideIt) {
  BallProjection view{camera()};
  const double f = 1500, depth = 8;
  const Eigen::Vector3d onAxis(959.5, 539.5, f / depth);
  for (const Pixel& p : outlinePixels(view, onAxis, 12))
    EXPECT_NEAR((p - Pixel(959.5, 539.5)).norm(), f * std::tan(std::asin(1 / depth)), 1e-9);
  // Beside it, the outline in the plane of axis and centre lies at the angles theta +- asin(1 / distance).
  const Eigen::Vector3d beside(1459.5, 539.5, f / depth);
  const double theta = std::atan2(500, f), half = std::asin(1 / (depth / std::cos(theta)));
  double least = 1e9, most = 0;
  for (const Pixel& p : outlinePixels(view, beside, 3600)) least = std::min(least, p.x()), most = std::max(most, p.x());
  EXPECT_NEAR(least, 959.5 + f * std::tan(theta - half), 1e-3);  // of a chord of a tenth of a degree
  EXPECT_NEAR(most, 959.5 + f * std::tan(theta + half), 1e-3);
}

TEST(OutlinePixels, DistantAndDegenerate) {
  const std::vector<Pixel> circle = outlinePixels({}, {40, 30, 12}, 8);
  ASSERT_EQ(circle.size(), 8U);
  for (const Pixel& p : circle) EXPECT_NEAR((p - Pixel(40, 30)).norm(), 12, 1e-12);
  EXPECT_TRUE(outlinePixels({camera()}, {959.5, 539.5, 1500 / 0.5}, 8).empty());  // the camera stands in the ball
}

TEST(CircleThrough, Nominal) {
  const auto c = circleThrough({13, 4}, {3, 14}, {3 + 6, 4 + 8});
  ASSERT_TRUE(c);
  EXPECT_LT((c->centre - Eigen::Vector2d(3, 4)).norm(), 1e-12);
  EXPECT_NEAR(c->radius, 10, 1e-12);
}

TEST(CircleThrough, Scale) {
  for (const double s : {1e-3, 1e5}) {
    const auto c = circleThrough(s * Eigen::Vector2d(13, 4), s * Eigen::Vector2d(3, 14), s * Eigen::Vector2d(9, 12));
    ASSERT_TRUE(c);
    EXPECT_NEAR(c->radius, s * 10, s * 1e-10);
  }
}

// Clicks that are 0.5 px off, a third of the way around apart from each other, leave a radius of 300 px right to about as much.
TEST(CircleThrough, Noise) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal(0, 0.5);
  double squares = 0;
  constexpr int kDraws = 1000;
  for (int i = 0; i < kDraws; ++i) {
    std::array<Eigen::Vector2d, 3> p;
    for (int k = 0; k < 3; ++k) {
      const double t = 2 * M_PI * k / 3 + 0.3;
      p[std::size_t(k)] = Eigen::Vector2d(500, 400) + (300 + normal(random)) * Eigen::Vector2d(std::cos(t), std::sin(t));
    }
    squares += std::pow(circleThrough(p[0], p[1], p[2])->radius - 300, 2) / kDraws;
  }
  EXPECT_NEAR(std::sqrt(squares), 0.5 / std::sqrt(3.0), 0.03);  // the mean of three radial errors, to first order
}

TEST(CircleThrough, DegenerateIsRefusedByName) {
  EXPECT_EQ(circleThrough({0, 0}, {1, 1}, {2, 2}).failure().reason, Reason::RankDeficient);
  EXPECT_EQ(circleThrough({5, 5}, {5, 5}, {7, 2}).failure().reason, Reason::RankDeficient);
  EXPECT_EQ(circleThrough({5, 5}, {5, 5}, {5, 5}).failure().reason, Reason::RankDeficient);
  EXPECT_EQ(circleThrough({NAN, 5}, {1, 5}, {5, 2}).failure().reason, Reason::NotFinite);
}

}  // namespace glint::mirror_ball_tests
