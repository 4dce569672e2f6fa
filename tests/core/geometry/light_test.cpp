// SPDX-License-Identifier: BSD-3-Clause
#include "core/geometry/light.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>

#include "tests/tolerances.h"

namespace glint {
namespace {
using tolerance::kExact;

TEST(Light, FiniteAndAtInfinity) {
  const Light near = Light::at({1, 2, 3});
  EXPECT_FALSE(near.atInfinity());
  EXPECT_NEAR((near.position() - Eigen::Vector3d(1, 2, 3)).norm(), 0, kExact);
  EXPECT_NEAR(near.homogeneous().norm(), 1, kExact);
  EXPECT_NEAR((near.directionFrom({1, 2, 1}) - Eigen::Vector3d(0, 0, 1)).norm(), 0, kExact);
  const Light far = Light::towards({0, 3, 4});
  EXPECT_TRUE(far.atInfinity());
  EXPECT_NEAR((far.directionFrom({9, 9, 9}) - Eigen::Vector3d(0, 0.6, 0.8)).norm(), 0, kExact);
}

TEST(Light, AnyMultipleIsTheSameLight) {
  for (const double k : {1.0, -1.0, 1e-200, -1e200}) {
    const Light l = Light::homogeneous(k * Eigen::Vector4d(2, 4, 6, 2));
    EXPECT_NEAR((l.position() - Eigen::Vector3d(1, 2, 3)).norm(), 0, kExact) << k;
    EXPECT_GE(l.homogeneous().w(), 0);
  }
  EXPECT_THROW(Light::towards({0, 0, 0}), std::invalid_argument);
  EXPECT_THROW(Light::at({NAN, 0, 0}), std::invalid_argument);
}

// Oracle: the angle in long double from a rotation by a known angle.
TEST(IncidentAngle, KeepsItsDigitsNearZero) {
  const Eigen::Vector3d n(0, 0, 1);
  for (const double angle : {1e-12, 1e-8, 1e-3, 0.1, 1.0}) {
    // V = N turned by +t + angle, L = N turned by -t + angle: H is N turned by angle.
    const double t = 0.3;
    const Eigen::Vector3d v(std::sin(t + angle), 0, std::cos(t + angle)), l(std::sin(angle - t), 0, std::cos(angle - t));
    EXPECT_NEAR(incidentAngle(n, l, v), angle, 1e-16 + 4e-16 * (1 + angle)) << angle;
  }
  EXPECT_TRUE(std::isnan(incidentAngle(n, {1, 0, 0}, {-1, 0, 0})));
}

TEST(Reflect, IsAnInvolutionThatKeepsTheNormalPart) {
  std::mt19937 rng(5);
  std::normal_distribution<double> g;
  for (int i = 0; i < 50; ++i) {
    const Eigen::Vector3d n = Eigen::Vector3d(g(rng), g(rng), g(rng)).normalized(),
                          v = Eigen::Vector3d(g(rng), g(rng), g(rng)).normalized();
    const Eigen::Vector3d r = reflect(v, n);
    EXPECT_NEAR((reflect(r, n) - v).norm(), 0, kExact);
    EXPECT_NEAR(r.dot(n), v.dot(n), kExact);
    EXPECT_NEAR(n.cross(r + v).norm(), 0, kExact);
  }
}

}  // namespace
}  // namespace glint
