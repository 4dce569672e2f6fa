// SPDX-License-Identifier: BSD-3-Clause
#include "core/highlight/diffuse.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/highlight/highlight.h"

namespace glint::diffuse_tests {
namespace {

constexpr int kSide = 160;

/// A shaded ball's disc, with squares of paint where `contrast` is above 1.
Image ball(double contrast, double noise, double scale = 1) {
  Image image(kSide, kSide, 1);
  std::mt19937 engine(1);
  std::normal_distribution<double> gauss(0, noise);
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      const double u = (x - 79.5) / 110, v = (y - 79.5) / 110;
      const double shade = std::sqrt(std::max(0.0, 1 - u * u - v * v));
      const double paint = ((x / 10) + (y / 10)) % 2 == 0 ? 1 : 1 / contrast;
      image.at(x, y) = static_cast<float>(scale * (shade * paint + gauss(engine)));
    }
  return image;
}
std::vector<char> all() { return std::vector<char>(static_cast<std::size_t>(kSide) * kSide, 1); }

TEST(FineStructure, SquaresOfPaintAreTextureAndShadingIsNot) {
  const FineStructure painted = fineStructure(ball(5, 0), all());
  EXPECT_TRUE(painted.isTexture());
  // At the edges a pixel is half of the difference of 0.8 from the mean of both sides; a fifth of the pixels is nearly as far.
  EXPECT_GT(painted.amount, 0.2);
  EXPECT_LT(painted.amount, 0.4);
  EXPECT_FALSE(fineStructure(ball(1, 0), all()).isTexture());
}

TEST(FineStructure, FollowsTheScaleOfValues) {
  const FineStructure one = fineStructure(ball(5, 0), all()), large = fineStructure(ball(5, 0, 1000), all());
  EXPECT_NEAR(large.amount / one.amount, 1000, 0.01);
  EXPECT_NEAR(large.top / one.top, 1000, 0.01);
}

TEST(FineStructure, NoiseIsNoTexture) {
  EXPECT_FALSE(fineStructure(ball(1, 0.05), all()).isTexture());
  EXPECT_TRUE(fineStructure(ball(5, 0.02), all()).isTexture());
}

TEST(FineStructure, FewOrNoPixelsSayNothing) {
  std::vector<char> few(static_cast<std::size_t>(kSide) * kSide, 0);
  EXPECT_FALSE(fineStructure(ball(5, 0), few).isTexture());
  std::fill(few.begin(), few.begin() + 300, 1);
  EXPECT_EQ(fineStructure(ball(5, 0), few).amount, 0);
}

/// A Gaussian highlight as bright as the paint that it lies on: over the diffuse light it is what it is without paint.
TEST(DiffuseLight, TakenOffLeavesTheHighlight) {
  Image diffuse = ball(5, 0), both = diffuse;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x)
      both.at(x, y) += static_cast<float>(std::exp(-((x - 83) * (x - 83) + (y - 74) * (y - 74)) / 288.0));
  const DiffuseLight under{0, 0, diffuse};
  DetectOptions options;
  options.under = &under;
  const auto found = detectHighlights(both, nullptr, options);
  ASSERT_TRUE(found);
  ASSERT_EQ(found->size(), 1u);
  EXPECT_NEAR((found->front().peak - Pixel(83, 74)).norm(), 0, 0.01);
  // Half of the peak lies at 12 sqrt(2 ln 2) px.
  EXPECT_NEAR(std::sqrt(found->front().areaPx2 / M_PI), 12 * std::sqrt(2 * std::log(2.0)), 0.05);
}

TEST(DiffuseLight, WhereItIsUnknownNothingIsUsed) {
  Image both = ball(1, 0);
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x)
      both.at(x, y) += static_cast<float>(std::exp(-((x - 83) * (x - 83) + (y - 74) * (y - 74)) / 288.0));
  Image corner(20, 20, 1);
  for (int y = 0; y < 20; ++y)
    for (int x = 0; x < 20; ++x) corner.at(x, y) = both.at(x, y);
  const DiffuseLight elsewhere{0, 0, corner};
  DetectOptions options;
  options.under = &elsewhere;
  EXPECT_FALSE(detectHighlights(both, nullptr, options));
}

}  // namespace
}  // namespace glint::diffuse_tests
