// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/residual_spread.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "tests/tolerances.h"

namespace glint {
namespace {

// Two waves around a contour: rho_k = cos(2 pi k / 36), above the 2 / sqrt(72) = 0.236 that is noticed up to k = 7. The last is
// 0.342, less than twice that, and counts by its part.
TEST(ResidualSpread, OfAWaveAroundAContour) {
  constexpr int n = 72;
  std::vector<double> wave;
  for (int i = 0; i < n; ++i) wave.push_back(0.3 * std::cos(2 * std::numbers::pi * i / 36 + 0.4));
  double inflation = 1;
  for (int k = 1; k <= 6; ++k) inflation += 2 * std::cos(2 * std::numbers::pi * k / 36);
  const double last = std::cos(2 * std::numbers::pi * 7 / 36), noticed = 2 / std::sqrt(72.0);
  inflation += 2 * last * (last / noticed - 1);
  const ResidualSpread spread = residualSpread(wave, std::vector<int>(n, 0), 4, 1);
  EXPECT_NEAR(spread.degreesOfFreedom, (n - 4) / inflation, 1e-9);
  EXPECT_NEAR(spread.factor, inflation * 0.5 * 0.3 * 0.3 * n / (n - 4), 1e-12);
}

// One wave and then five: their correlation dips to what is noticed and rises again behind it. Where a lag came in or fell out as
// a whole, a fit that uses the sum and changes the residuals went to and fro.
TEST(CorrelationInflation, HasNoJumps) {
  constexpr int n = 72, kSteps = 2000;
  constexpr double kPerStep = 0.02;  // the sum is below 2 * 36 and changes by its own size over a tenth of the way
  double before = 0, most = 0, largest = 0;
  for (int step = 0; step <= kSteps; ++step) {
    const double t = double(step) / kSteps;
    std::vector<double> values;
    for (int i = 0; i < n; ++i)
      values.push_back((1 - t) * std::cos(2 * std::numbers::pi * i / n) + t * std::cos(5 * 2 * std::numbers::pi * i / n));
    const double inflation = correlationInflation(values, std::vector<int>(n, 0), Neighbours::Closed);
    if (step > 0) most = std::max(most, std::abs(inflation - before));
    largest = std::max(largest, inflation);
    before = inflation;
  }
  EXPECT_LT(most, kPerStep * largest);
}

TEST(CorrelationInflation, OfNothing) {
  EXPECT_EQ(correlationInflation({}, {}, Neighbours::Closed), 1);
  EXPECT_EQ(correlationInflation({0, 0, 0}, {0, 0, 0}, Neighbours::Closed), 1);
  EXPECT_EQ(correlationInflation({1, -1, 1, -1}, {0, 0, 0, 0}, Neighbours::Closed), 1);  // neighbours that cancel promise nothing
  EXPECT_THROW((void)correlationInflation({1, 2}, {0}, Neighbours::Closed), std::invalid_argument);
}

// Whoever gives a contour may start anywhere and go either way round. Lines with ends are told apart from it.
TEST(ResidualSpread, DoesNotDependOnWhereAContourStarts) {
  std::mt19937 random(8);
  std::normal_distribution<double> normal(0, 0.1);
  std::vector<double> residuals;
  std::vector<int> views;
  for (const int size : {48, 30, 72})
    for (int i = 0; i < size; ++i) {
      residuals.push_back(0.2 + 0.01 * i + normal(random));  // a ramp: the last and the first are least alike
      views.push_back(size);
    }
  const ResidualSpread spread = residualSpread(residuals, views, 4, 10);
  EXPECT_GT(spread.degreesOfFreedom, 1);
  std::vector<double> turned = residuals;
  std::rotate(turned.begin(), turned.begin() + 17, turned.begin() + 48);
  std::reverse(turned.begin() + 48, turned.begin() + 78);
  std::rotate(turned.begin() + 78, turned.begin() + 140, turned.end());
  const ResidualSpread other = residualSpread(turned, views, 4, 10);
  EXPECT_NEAR(other.factor / spread.factor, 1, tolerance::kExact);
  EXPECT_NEAR(other.degreesOfFreedom / spread.degreesOfFreedom, 1, tolerance::kExact);
  EXPECT_GT(std::abs(residualSpread(turned, views, 4, 10, Neighbours::Open).factor /
                         residualSpread(residuals, views, 4, 10, Neighbours::Open).factor -
                     1),
            1e-3);
}

TEST(RmsWithoutTail, IsTheRmsWhereNothingSticksOut) {
  EXPECT_NEAR(rmsWithoutTail({3, -4}), std::sqrt(12.5), tolerance::kExact);
  EXPECT_NEAR(rmsWithoutTail({-2}), 2, tolerance::kExact);
  std::vector<double> wave;  // what a contour of the wrong shape leaves: largest value 1.41 times the RMS
  for (int i = 0; i < 720; ++i) wave.push_back(7 * std::cos(2 * i * std::numbers::pi / 360));
  EXPECT_NEAR(rmsWithoutTail(wave), 7 / std::sqrt(2), tolerance::kExact);
}

TEST(RmsWithoutTail, BoundsAFewByHand) {
  // Two thirds are 1 or less, so that the last one counts as 2: (5 + 4) / 6.
  for (const double wild : {2.0, 50.0, -1e12})
    EXPECT_NEAR(rmsWithoutTail({1, wild, -1, 1, 1, -1}), std::sqrt(1.5), tolerance::kExact) << wild;
  // A third exactly is a tail still, two fifths are not: (1 + 1 + 4) / 3, (3 + 2 * 81) / 5.
  EXPECT_NEAR(rmsWithoutTail({1, 9, 1}), std::sqrt(2.0), tolerance::kExact);
  EXPECT_NEAR(rmsWithoutTail({9, 1, 1, 9, 1}), std::sqrt(33.0), tolerance::kExact);
}

// 0.967 sigma bounds two thirds of a normal, so that the cut is at c = 1.935: sqrt(P(|x| < c) - 2 c phi(c) + c^2 P(|x| > c)) =
// 0.953.
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
