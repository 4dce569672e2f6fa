// SPDX-License-Identifier: BSD-3-Clause
#include "core/light/directed_limit.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/geometry/light.h"
#include "tests/tolerances.h"

namespace glint {
namespace {

constexpr double kDirectedLimit = 0.08;

/// The normal tilted by 0.05 towards an azimuth, seen and lit from straight above.
Eigen::Vector3d tilted(double azimuth) {
  return {std::sin(0.05) * std::cos(azimuth), std::sin(0.05) * std::sin(azimuth), std::cos(0.05)};
}

// L = V = H = z: a light moved by d sideways moves H by d / (2 r). The limit becomes an ellipse of semi-axes a and hypot(a, s /
// (2 r)).
TEST(DirectedLimit, IsAnEllipseUnderALightStraightAbove) {
  const double r = 2.5, s = 0.3, longer = std::hypot(kDirectedLimit, s / (2 * r));
  for (const double scale : {1e-6, 1.0, 1e6}) {
    Eigen::Matrix3d extent = Eigen::Matrix3d::Zero();
    extent(0, 0) = s * s * scale * scale;
    extent(2, 2) = 7 * scale * scale;  // along the ray: not seen
    for (const double azimuth : {0.0, 0.4, 1.0, M_PI / 2, 2.0, M_PI, 5.0}) {
      const double expected = 1 / std::hypot(std::cos(azimuth) / longer, std::sin(azimuth) / kDirectedLimit);
      const Eigen::Vector3d origin(1 * scale, 2 * scale, 0);
      for (const double size : {1.0, -3e4})  // any multiple of (l, w) is the same light
        EXPECT_NEAR(directedLimit(kDirectedLimit, extent, origin, tilted(azimuth), {0, 0, 1},
                                  size * Eigen::Vector4d(scale, 2 * scale, r * scale, 1)),
                    expected, 1e-10)
            << scale << " " << azimuth;  // extent(2, 2) cancels to round-off
    }
  }
}

TEST(DirectedLimit, OfALightAtInfinityIsAngular) {
  Eigen::Matrix3d extent = Eigen::Matrix3d::Zero();
  extent(1, 1) = 0.01;
  EXPECT_NEAR(directedLimit(kDirectedLimit, extent, {5, 6, 7}, tilted(M_PI / 2), {0, 0, 1}, {0, 0, 1, 0}),
              std::hypot(kDirectedLimit, 0.05), tolerance::kExact);
  // The same from very far away, as an extent in metres.
  EXPECT_NEAR(directedLimit(kDirectedLimit, 1e12 * extent, {5, 6, 7}, tilted(M_PI / 2), {0, 0, 1}, {0, 0, 1e6, 1}),
              std::hypot(kDirectedLimit, 0.05), 1e-6);
}

TEST(DirectedLimit, DegenerateInputsGiveAPositiveAngle) {
  const Eigen::Matrix3d none = Eigen::Matrix3d::Zero();
  EXPECT_DOUBLE_EQ(directedLimit(kDirectedLimit, none, {0, 0, 0}, tilted(1), {0, 0, 1}, {0, 0, 2, 1}), kDirectedLimit);
  EXPECT_DOUBLE_EQ(directedLimit(kDirectedLimit, Eigen::Matrix3d::Identity(), {0, 0, 0}, {0, 0, 1}, {0, 0, 1}, {0, 0, 2, 1}),
                   kDirectedLimit)
      << "no direction at the peak";
  EXPECT_DOUBLE_EQ(directedLimit(kDirectedLimit, Eigen::Matrix3d::Identity(), {0, 0, 2}, tilted(1), {0, 0, 1}, {0, 0, 2, 1}),
                   kDirectedLimit)
      << "at the light";
  for (const double azimuth : {0.0, 0.7, 2.0})
    EXPECT_NEAR(directedLimit(kDirectedLimit, -Eigen::Matrix3d::Identity(), {0, 0, 0}, tilted(azimuth), {0, 0, 1}, {0, 0, 2, 1}),
                0.1 * kDirectedLimit, tolerance::kExact);
}

/// By central differences of directedLimit(), which the tests above hold to closed forms.
void expectDerivatives(double limit, const Vector6& extent, const Eigen::Vector3d& point, const Eigen::Vector3d& n,
                       const Eigen::Vector3d& toCamera, const Eigen::Vector4d& light) {
  constexpr double kStep = 1e-6;        // of the size of what is moved: the cut-off error goes with its square
  constexpr double kDifference = 2e-7;  // relative: round-off over the step, with some digits for what cancels
  const DirectedLimit d = directedLimitWithDerivatives(limit, symmetric(extent), point, n, toCamera, light);
  EXPECT_DOUBLE_EQ(d.angle, directedLimit(limit, symmetric(extent), point, n, toCamera, light));
  const double da = kStep * limit;
  EXPECT_NEAR(d.byLimit,
              (directedLimit(limit + da, symmetric(extent), point, n, toCamera, light) -
               directedLimit(limit - da, symmetric(extent), point, n, toCamera, light)) /
                  (2 * da),
              kDifference);
  const int components = light.w() == 0 ? 3 : 4;  // at w = 0 the unit of the extent changes
  Eigen::Vector4d byLight = Eigen::Vector4d::Zero();
  const double dl = kStep * light.norm();
  for (int i = 0; i < components; ++i) {
    const Eigen::Vector4d step = dl * Eigen::Vector4d::Unit(i);
    byLight(i) = (directedLimit(limit, symmetric(extent), point, n, toCamera, light + step) -
                  directedLimit(limit, symmetric(extent), point, n, toCamera, light - step)) /
                 (2 * dl);
  }
  EXPECT_LT((d.byLight - byLight).head(components).norm(), kDifference * (byLight.norm() + limit / light.norm()) * 10);
  const double de = kStep * std::max(extent.norm(), limit * limit);
  Vector6 byExtent;
  for (int i = 0; i < 6; ++i) {
    const Vector6 step = de * Vector6::Unit(i);
    byExtent(i) = (directedLimit(limit, symmetric(extent + step), point, n, toCamera, light) -
                   directedLimit(limit, symmetric(extent - step), point, n, toCamera, light)) /
                  (2 * de);
  }
  EXPECT_LT((d.byExtent - byExtent).norm(),
            kDifference * byExtent.norm() + 1e-12 / limit);  // none if the limit is held at its least
}

TEST(DirectedLimit, DerivativesAreThoseOfTheAngle) {
  const Eigen::Vector3d point(0.3, -0.2, 0.1), n = Eigen::Vector3d(0.1, -0.2, 1).normalized(),
                                               v = Eigen::Vector3d(0.5, 0.1, 0.8).normalized();
  Vector6 extent;
  extent << 0.03, 0.02, 0.05, 0.01, -0.004, 0.006;
  for (const Eigen::Vector4d& light :
       {Eigen::Vector4d(-0.4, -0.6, 1.7, 1), Eigen::Vector4d(-0.2, -0.3, 0.9, 0.3), Eigen::Vector4d(0.4, 0.6, -1.7, -1),
        Eigen::Vector4d(-0.4, -0.6, 1.7, 0), Eigen::Vector4d(0.1, 0.5, -1.2, 0.7)}) {
    SCOPED_TRACE(light.transpose());
    for (const double size : {0.0, 0.1, 1.0, 5.0}) {
      SCOPED_TRACE(size);
      expectDerivatives(kDirectedLimit, size * extent, point, n, v, light);
    }
  }
}

// The normal leans along y in the plane of x = 0, so that t is y and p is x but for signs: an extent of -I along x is the one
// that divides.
TEST(DirectedLimit, DerivativesWhereTheExtentIsNegative) {
  const Eigen::Vector3d point(0, 0, 0), n = tilted(M_PI / 2), v(0, 0, 1);
  const Eigen::Vector4d light(0, 0, 2, 1);
  Vector6 across = Vector6::Zero(), all = Vector6::Zero();
  across << -1, 0.01, 0, 0.0005, 0, 0;
  all << -1, -1, -1, 0, 0, 0;
  expectDerivatives(kDirectedLimit, across, point, n, v, light);
  expectDerivatives(kDirectedLimit, all, point, n, v, light);
  EXPECT_NEAR(directedLimitWithDerivatives(kDirectedLimit, symmetric(all), point, n, v, light).byLimit, 0.1, tolerance::kExact);
}

}  // namespace
}  // namespace glint
