// SPDX-License-Identifier: BSD-3-Clause
#include "core/lamps/ball_outline.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "tests/core/lamps/ball_pictures.h"

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
  EXPECT_LT(largestError(found->outline, truth), 0.03);  // 0.012 measured
  EXPECT_GE(found->degreesOfFreedom, 110);
  EXPECT_LT(found->residualPx, 0.1);
}

}  // namespace glint::ball_outline_tests
