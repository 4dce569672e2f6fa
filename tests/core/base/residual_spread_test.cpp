// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/residual_spread.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "tests/tolerances.h"

namespace glint {
namespace {

TEST(RmsWithoutTail, IsTheRmsWhereNothingSticksOut) {
  EXPECT_NEAR(rmsWithoutTail({3, -4}), std::sqrt(12.5), tolerance::kExact);
  EXPECT_NEAR(rmsWithoutTail({-2}), 2, tolerance::kExact);
  std::vector<double> wave;  // what a contour of the wrong shape leaves: largest value 1.41 times the RMS
  for (int i = 0; i < 720; ++i) wave.push_back(7 * std::cos(2 * i * std::numbers::pi / 360));
  EXPECT_NEAR(rmsWithoutTail(wave), 7 / std::sqrt(2), tolerance::kExact);
}

TEST(RmsWithoutTail, BoundsAFewByHand) {
  // Two thirds are 1 or less, so that the last one counts as 2: (5 + 4) / 6.
  for (const double wild : {2.0, 50.0, -1e12}) EXPECT_NEAR(rmsWithoutTail({1, wild, -1, 1, 1, -1}), std::sqrt(1.5), tolerance::kExact) << wild;
  // A third exactly is a tail still, two fifths are not: (1 + 1 + 4) / 3, (3 + 2 * 81) / 5.
  EXPECT_NEAR(rmsWithoutTail({1, 9, 1}), std::sqrt(2.0), tolerance::kExact);
  EXPECT_NEAR(rmsWithoutTail({9, 1, 1, 9, 1}), std::sqrt(33.0), tolerance::kExact);
}

// 0.967 sigma bounds two thirds of a normal, so that the cut is at c = 1.935: sqrt(P(|x| < c) - 2 c phi(c) + c^2 P(|x| > c)) = 0.953.
TEST(RmsWithoutTail, OfNormalNoiseIsFivePercentLess) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal(0, 0.25);
  std::vector<double> noise(100000);
  for (double& n : noise) n = normal(random);
  EXPECT_NEAR(rmsWithoutTail(noise) / 0.25, 0.953, 0.01);
}

TEST(RmsWithoutTail, OfNothingAndOfNoNumber) {
  EXPECT_EQ(rmsWithoutTail({}), 0);
  EXPECT_EQ(rmsWithoutTail({0, 0, 0}), 0);
  for (const double no : {std::nan(""), std::numeric_limits<double>::infinity()})
    EXPECT_TRUE(std::isnan(rmsWithoutTail({1, 1, 1, 1, no}))) << "a point without a value is no tail";
}

}  // namespace
}  // namespace glint
