// SPDX-License-Identifier: BSD-3-Clause
#include "core/lamps/ball_outline.h"

#include <gtest/gtest.h>

#include <cmath>

namespace glint::ball_outline_tests {

/// A grey disc on black; the share of each pixel that it covers from the signed distance, exact to the curvature.
Image disc(int size, const Eigen::Vector2d& centre, double radius) {
  Image image(size, size, 1);
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) {
      const double inside = radius - (Eigen::Vector2d(x, y) - centre).norm();
      image.at(x, y) = static_cast<float>(120 / (1 + std::exp(-inside / 0.6)));
    }
  return image;
}

TEST(BallOutline, Nominal) {
  const Image image = disc(300, {151.3, 148.8}, 100.4);
  const auto found = refineBallOutline(std::span(&image, 1), {1000, 2000}, {{1150, 2150}, 103});
  ASSERT_TRUE(found) << found.failure().message();
  EXPECT_NEAR(found->outline.centre.x(), 1151.3, 0.02);
  EXPECT_NEAR(found->outline.centre.y(), 2148.8, 0.02);
  EXPECT_NEAR(found->outline.radius, 100.4, 0.05);
}

}  // namespace glint::ball_outline_tests
