// SPDX-License-Identifier: BSD-3-Clause
#include "core/light/directed_limit.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/light/light.h"
#include "tests/tolerances.h"

namespace glint {
namespace {

constexpr double kLimit = 0.08;

/// The normal tilted by 0.05 towards an azimuth, seen and lit from straight above.
Eigen::Vector3d tilted(double azimuth) {
  return {std::sin(0.05) * std::cos(azimuth), std::sin(0.05) * std::sin(azimuth), std::cos(0.05)};
}

// L = V = H = z: a light moved by d sideways moves H by d / (2 r). The limit becomes an ellipse of semi-axes a and hypot(a, s / (2 r)).
TEST(DirectedLimit, IsAnEllipseUnderALightStraightAbove) {
  const double r = 2.5, s = 0.3, longer = std::hypot(kLimit, s / (2 * r));
  for (const double scale : {1e-6, 1.0, 1e6}) {
    Eigen::Matrix3d extent = Eigen::Matrix3d::Zero();
    extent(0, 0) = s * s * scale * scale;
    extent(2, 2) = 7 * scale * scale;  // along the ray: not seen
    for (const double azimuth : {0.0, 0.4, 1.0, M_PI / 2, 2.0, M_PI, 5.0}) {
      const double expected = 1 / std::hypot(std::cos(azimuth) / longer, std::sin(azimuth) / kLimit);
      const Eigen::Vector3d origin(1 * scale, 2 * scale, 0);
      for (const double size : {1.0, -3e4})  // any multiple of (l, w) is the same light
        EXPECT_NEAR(directedLimit(kLimit, extent, origin, tilted(azimuth), {0, 0, 1}, size * Eigen::Vector4d(scale, 2 * scale, r * scale, 1)),
                    expected, 1e-10) << scale << " " << azimuth;  // extent(2, 2) cancels to round-off
    }
  }
}

TEST(DirectedLimit, OfALightAtInfinityIsAngular) {
  Eigen::Matrix3d extent = Eigen::Matrix3d::Zero();
  extent(1, 1) = 0.01;
  EXPECT_NEAR(directedLimit(kLimit, extent, {5, 6, 7}, tilted(M_PI / 2), {0, 0, 1}, {0, 0, 1, 0}), std::hypot(kLimit, 0.05), tolerance::kExact);
  // The same from very far away, as an extent in metres.
  EXPECT_NEAR(directedLimit(kLimit, 1e12 * extent, {5, 6, 7}, tilted(M_PI / 2), {0, 0, 1}, {0, 0, 1e6, 1}), std::hypot(kLimit, 0.05), 1e-6);
}

TEST(DirectedLimit, DegenerateInputsGiveAPositiveAngle) {
  const Eigen::Matrix3d none = Eigen::Matrix3d::Zero();
  EXPECT_DOUBLE_EQ(directedLimit(kLimit, none, {0, 0, 0}, tilted(1), {0, 0, 1}, {0, 0, 2, 1}), kLimit);
  EXPECT_DOUBLE_EQ(directedLimit(kLimit, Eigen::Matrix3d::Identity(), {0, 0, 0}, {0, 0, 1}, {0, 0, 1}, {0, 0, 2, 1}), kLimit) << "no direction at the peak";
  EXPECT_DOUBLE_EQ(directedLimit(kLimit, Eigen::Matrix3d::Identity(), {0, 0, 2}, tilted(1), {0, 0, 1}, {0, 0, 2, 1}), kLimit) << "at the light";
  for (const double azimuth : {0.0, 0.7, 2.0})
    EXPECT_NEAR(directedLimit(kLimit, -Eigen::Matrix3d::Identity(), {0, 0, 0}, tilted(azimuth), {0, 0, 1}, {0, 0, 2, 1}), 0.1 * kLimit, tolerance::kExact);
}

}  // namespace
}  // namespace glint
