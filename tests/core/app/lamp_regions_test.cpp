// SPDX-License-Identifier: BSD-3-Clause
// A region of 95 % holds 95 % of what is drawn with the covariance that it is made of.
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "core/app/lamp_answer.h"

namespace glint::lamp_regions_tests {

LampAnswer lampAt(double scale) {
  LampAnswer lamp;
  lamp.position = scale * Eigen::Vector3d(0.3, -0.2, 1.4);
  Eigen::Matrix3d root;
  root << 0.02, 0, 0, 0.01, 0.03, 0, -0.02, 0.05, 0.2;
  lamp.covariance = scale * scale * root * root.transpose();
  return lamp;
}

constexpr int kDraws = 40000;
constexpr double kSpread = 0.006;  // of a share of 95 % among 40000 draws 0.0011: five and a half of it

double shareInside(const LampAnswer& lamp) {
  const auto region = positionRegion(lamp);
  if (!region) return -1;
  const Eigen::Matrix3d root = lamp.covariance->llt().matrixL();
  const Eigen::Isometry3d bodyFromWorld = region->worldFromBody().inverse();
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  int inside = 0;
  for (int i = 0; i < kDraws; ++i) {
    const Eigen::Vector3d z(normal(random), normal(random), normal(random));
    const Eigen::Vector3d x = bodyFromWorld * Eigen::Vector3d(*lamp.position + root * z);
    inside += x.cwiseQuotient(region->semiAxes()).squaredNorm() <= 1;
  }
  return double(inside) / kDraws;
}

TEST(LampRegions, NominalPositionHolds95Percent) { EXPECT_NEAR(shareInside(lampAt(1)), 0.95, kSpread); }

TEST(LampRegions, Scale) {
  EXPECT_NEAR(shareInside(lampAt(1e-3)), 0.95, kSpread);
  EXPECT_NEAR(shareInside(lampAt(1e3)), 0.95, kSpread);
}

TEST(LampRegions, NoiseOfADirectionIsInItsCone) {
  LampAnswer lamp;
  constexpr double kEach = 0.004;  // rad, of either coordinate
  lamp.directionSigma = std::sqrt(2.0) * kEach;
  std::mt19937 random(6);
  std::normal_distribution<double> normal(0, kEach);
  int inside = 0;
  for (int i = 0; i < kDraws; ++i) inside += std::hypot(normal(random), normal(random)) <= directionRegion(lamp);
  EXPECT_NEAR(double(inside) / kDraws, 0.95, kSpread);
}

TEST(LampRegions, DegenerateHasNoRegion) {
  EXPECT_EQ(positionRegion(LampAnswer()).failure().reason, Reason::NotReached);
  LampAnswer lamp = lampAt(1);
  lamp.failure = Failure{Reason::NotConverged, ""};
  EXPECT_FALSE(positionRegion(lamp));
  lamp = lampAt(1);
  (*lamp.covariance)(1, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(positionRegion(lamp).failure().reason, Reason::NotFinite);
  lamp.directionSigma = std::numeric_limits<double>::infinity();
  EXPECT_EQ(directionRegion(lamp), std::numbers::pi);
  lamp.directionSigma = 0;
  EXPECT_EQ(directionRegion(lamp), 0);
}

}  // namespace glint::lamp_regions_tests
