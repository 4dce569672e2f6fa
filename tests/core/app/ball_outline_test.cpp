// SPDX-License-Identifier: BSD-3-Clause
#include "core/app/ball_outline.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <numbers>

#include "tests/core/app/ball_pictures.h"

namespace glint::ball_outline_tests {

using namespace ball_pictures;

/// A cut-out around a ball with a margin of a third of its radius.
struct CutOut {
  Eigen::Vector2d corner;
  int size;
  explicit CutOut(const BallOutline& ball, double margin = 0.33)
      : corner((ball.centre - Eigen::Vector2d::Constant((1 + margin) * ball.radius)).array().floor()),
        size(static_cast<int>(2 * (1 + margin) * ball.radius)) {}
};

Outcome<RefinedOutline> refineIn(const Image& image, const CutOut& at, const BallOutline& start) {
  return refineBallOutline(std::span(&image, 1), at.corner, start);
}

double largestError(const BallOutline& found, const BallOutline& truth) {
  return std::max((found.centre - truth.centre).cwiseAbs().maxCoeff(), std::abs(found.radius - truth.radius));
}

TEST(BallOutline, Nominal) {
  const BallOutline truth{{1151.37, 2148.81}, 100.43};
  const CutOut at(truth);
  const Image image = photograph(render(blackBall(truth), at.corner, at.size, at.size, 6), 1.2);
  const auto found = refineIn(image, at, {truth.centre + Eigen::Vector2d(5, -6), 94});
  ASSERT_TRUE(found) << found.failure().message();
  std::printf("nominal: error %.3f px\n", largestError(found->outline, truth));
  EXPECT_LT(largestError(found->outline, truth), 0.03);
  EXPECT_GE(found->degreesOfFreedom, 110);
  EXPECT_LT(found->residualPx, 0.1);
}

TEST(BallOutline, Scale) {
  for (const double radius : {20.3, 40.7, 400.2, 1500.6}) {
    const BallOutline truth{{5000.3, 3000.6}, radius};
    const CutOut at(truth, 0.25);
    const double blur = std::max(0.8, radius / 400);  // one ray for each pixel is enough where the blur is four pixels
    const Image image = photograph(render(blackBall(truth), at.corner, at.size, at.size,
                                          radius > 1000  ? 1
                                          : radius > 300 ? 2
                                                         : 6),
                                   blur);
    const auto found = refineIn(image, at, {truth.centre + 0.06 * radius * Eigen::Vector2d(1, 0.5), 0.94 * radius});
    ASSERT_TRUE(found) << radius << ": " << found.failure().message();
    std::printf("radius %.1f: error %.3f px\n", radius, largestError(found->outline, truth));
    EXPECT_LT(largestError(found->outline, truth), 0.06) << radius;
  }
}

/// Twenty photographs of their own with noise of four grey levels, as JPEG.
TEST(BallOutline, NoiseIsWhatTheCovarianceSays) {
  const BallOutline truth{{300.4, 299.7}, 150.2};
  const CutOut at(truth);
  const cv::Mat linear = render(blackBall(truth, 0.05), at.corner, at.size, at.size, 3);
  double squares = 0, normalised = 0;
  const int runs = 20;
  for (int seed = 0; seed < runs; ++seed) {
    const auto found = refineIn(photograph(linear, 1.5, 4, seed + 1, 85), at, {truth.centre, 155});
    ASSERT_TRUE(found) << found.failure().message();
    const Eigen::Vector3d error(found->outline.centre.x() - truth.centre.x(), found->outline.centre.y() - truth.centre.y(),
                                found->outline.radius - truth.radius);
    squares += error.squaredNorm() / (3 * runs);
    normalised += error.dot(found->covariance.inverse() * error) / (3 * runs);
  }
  std::printf("noise: rms %.3f px, normalised %.2f\n", std::sqrt(squares), normalised);
  EXPECT_LT(std::sqrt(squares), 0.05);
  EXPECT_GT(normalised, 0.1);  // the covariance has what all edges may have wrong together, too: here nothing
  EXPECT_LT(normalised, 3);
}

/// Far from the axis of a wide lens the outline is an ellipse. Its edge points lie on the cone that touches the ball, sin(alpha)
/// = 1 / distance.
TEST(BallOutline, ASphereUnderPerspectiveIsItsCone) {
  Scene scene = blackBall({{0, 0}, 100});
  scene.focal = 900;
  scene.principal = {800, 600};
  scene.balls = {Eigen::Vector3d(3.1, -1.7, 7.0)};
  const Eigen::Vector3d axis = scene.balls[0].normalized();
  const double alpha = std::asin(1 / scene.balls[0].norm()), distance = scene.balls[0].norm();
  const Eigen::Vector2d middle = scene.principal + scene.focal * axis.head<2>() / axis.z();
  const BallOutline start{middle, scene.focal / axis.z() * std::tan(alpha) * 1.03};
  const CutOut at(start);
  const Image image = photograph(render(scene, at.corner, at.size, at.size, 4), 1);
  const auto off = [&](const Outcome<RefinedOutline>& found) {  // rms of the angle to the axis less alpha, px
    double sum = 0;
    for (const EdgePoint& e : found->edge) {
      const Eigen::Vector2d p = (e.place - scene.principal) / scene.focal;
      const double angle = std::acos(std::min(1.0, Eigen::Vector3d(p.x(), p.y(), 1).normalized().dot(axis)));
      sum += std::pow((angle - alpha) * scene.focal, 2);
    }
    return std::sqrt(sum / static_cast<double>(found->edge.size()));
  };
  const auto found = refineBallOutline(std::span(&image, 1), at.corner, start, OutlineCamera{scene.focal, scene.principal});
  ASSERT_TRUE(found) << found.failure().message();
  std::printf("cone: edges %.3f px off, residual %.3f px, %d degrees of freedom\n", off(found), found->residualPx,
              found->degreesOfFreedom);
  EXPECT_GE(found->degreesOfFreedom, 110);
  EXPECT_LT(off(found), 0.1);
  EXPECT_LT(found->residualPx, 0.1);
  // The middle of the ellipse, Q* = C C^T - I: not the image of the ball's centre.
  const Eigen::Vector3d c = scene.balls[0];
  const Eigen::Vector2d centre = scene.principal + scene.focal * c.z() / (c.z() * c.z() - 1) * c.head<2>();
  EXPECT_NEAR((found->outline.centre - centre).norm(), 0, 0.3);
  EXPECT_GT((middle - centre).norm(), 5) << distance;
  // Without the camera the circle misses: it must not look as good.
  const auto circle = refineBallOutline(std::span(&image, 1), at.corner, start);
  EXPECT_TRUE(!circle || circle->residualPx > 3 * found->residualPx);
}

/// A mirror shows the background behind it along its edge, so that no single photograph shows all of the outline; all together
/// do.
TEST(BallOutline, PhotographsUnderSeveralLampsAreUsedTogether) {
  const BallOutline truth{{250.3, 251.8}, 180.5};
  Scene scene = blackBall(truth);
  scene.mirrors = 0.6;
  const CutOut at(truth);
  std::vector<Image> photographs;
  for (int k = 0; k < 4;
       ++k) {  // each lamp lights a third of the background, up to 26 degrees from the optical axis; the room is dark
    scene.light = [k](const Eigen::Vector3d& d) { return d.z() > 0.9 && around(d, 90.0 * k + 30, 50) ? 0.12 : 0.0; };
    photographs.push_back(photograph(render(scene, at.corner, at.size, at.size, 3), 1.2, 1, k + 1, 92));
  }
  const BallOutline start{truth.centre + Eigen::Vector2d(6, 4), 176};
  EXPECT_FALSE(refineBallOutline(std::span(photographs).first(1), at.corner, start))
      << "one photograph shows enough: the test tests nothing";
  const auto found = refineBallOutline(photographs, at.corner, start);
  ASSERT_TRUE(found) << found.failure().message();
  std::printf("four lamps: error %.3f px\n", largestError(found->outline, truth));
  EXPECT_LT(largestError(found->outline, truth), 0.5);  // 0.25 measured: the rim reflects what is lit behind it
}

/// A bright, rough stand hides a quarter; a shadow runs up to the ball.
TEST(BallOutline, AHiddenQuarterDoesNotMoveIt) {
  const BallOutline truth{{250.3, 251.8}, 180.5};
  const CutOut at(truth);
  cv::Mat linear = render(blackBall(truth), at.corner, at.size, at.size, 3);
  const int floor = static_cast<int>(truth.centre.y() - at.corner.y() + 0.72 * truth.radius);
  std::mt19937 random(5);
  for (int y = floor; y < linear.rows; ++y)
    for (int x = 0; x < linear.cols; ++x) linear.at<double>(y, x) = 0.2 + 0.4 * static_cast<double>(random() % 1000) / 1000;
  const auto found = refineIn(photograph(linear, 1.2, 1, 1, 92), at, {truth.centre + Eigen::Vector2d(-8, 9), 185});
  ASSERT_TRUE(found) << found.failure().message();
  std::printf("hidden quarter: error %.3f px\n", largestError(found->outline, truth));
  EXPECT_LT(largestError(found->outline, truth), 0.15);
}

TEST(BallOutline, DegenerateIsRefusedByName) {
  const BallOutline ball{{150, 150}, 100};
  const CutOut at(ball);
  const auto reasonOf = [&](const Image& image, const BallOutline& start) {
    const auto found = refineIn(image, at, start);
    return found ? std::string("found") : std::string(nameOf(found.failure().reason));
  };
  const cv::Mat even(at.size, at.size, CV_64F, cv::Scalar(0.1)), disc = render(blackBall(ball), at.corner, at.size, at.size, 3);
  EXPECT_EQ(reasonOf(photograph(even, 0), ball), "too few points") << "even grey";
  EXPECT_EQ(reasonOf(photograph(even, 0, 6), ball), "too few points") << "noise";
  cv::Mat ramp = even.clone();
  for (int y = 0; y < ramp.rows; ++y)
    for (int x = 0; x < ramp.cols; ++x) ramp.at<double>(y, x) = x > 120 ? 0.3 : 0.02;
  EXPECT_EQ(reasonOf(photograph(ramp, 1, 2), ball), "too few points") << "one straight edge";
  EXPECT_NE(reasonOf(photograph(disc, 1), {ball.centre + Eigen::Vector2d(60, 0), 60}), "found") << "the ball lies elsewhere";
  cv::Mat half = disc.clone();
  half.colRange(0, half.cols / 2 + 20).setTo(0.1);
  EXPECT_EQ(reasonOf(photograph(half, 1), ball), nameOf(Reason::RankDeficient)) << "one side only";
  Image broken = photograph(disc, 1);
  broken.at(3, 3) = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(reasonOf(broken, ball), nameOf(Reason::NotFinite));
  EXPECT_EQ(reasonOf(photograph(disc, 1), {{5000, 150}, 100}), nameOf(Reason::OutsideImage));
}

}  // namespace glint::ball_outline_tests
