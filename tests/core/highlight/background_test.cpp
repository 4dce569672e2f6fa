// SPDX-License-Identifier: BSD-3-Clause
#include "core/highlight/background.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/highlight/highlight.h"

namespace glint {
namespace {

constexpr int kSize = 240;
constexpr double kRadius = 22, kPeak = 0.8;  // px at half the peak; radiance

struct Blob {
  bool longTail = false;
  double slope = 0;  ///< of a shading under it, across the image
  double noise = 0;
};

/// A round highlight of half width kRadius: level^(rho^2), or GGX's shape, over a shading.
Image imageOf(const Blob& b) {
  Image image(kSize, kSize, 1);
  std::mt19937_64 engine(5);
  std::normal_distribution<double> gauss(0, b.noise > 0 ? b.noise : 1);
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x) {
      const double rho2 = (std::pow(x - 119.5, 2) + std::pow(y - 118.25, 2)) / (kRadius * kRadius);
      const double lobe = b.longTail ? std::pow(1 + (std::sqrt(2.0) - 1) * rho2, -2) : std::pow(0.5, rho2);
      image.at(x, y) = float(kPeak * lobe + 0.1 + b.slope * x / kSize + (b.noise > 0 ? gauss(engine) : 0));
    }
  return image;
}

struct Measured {
  double saidPct, truePct;  ///< of the diameter
};
Measured measured(const Blob& b) {
  const Image image = imageOf(b);
  const auto found = detectHighlights(image, nullptr, DetectOptions{});
  EXPECT_TRUE(found) << (found ? "" : found.failure().message());
  const Highlight& h = found->front();
  Footprint footprint;
  footprint.centre = h.ellipse->centre;
  footprint.shape = h.ellipse->semiAxes.cwiseAbs2().asDiagonal();
  const std::vector<char> usable(image.data.size(), 1);
  return {backgroundUncertaintyPct(image, usable, footprint, h.peakValue),
          50 * std::abs(std::sqrt(h.areaPx2 / M_PI) / kRadius - 1)};
}

// The contour of a long-tailed lobe comes out too small, and the figure that is said covers the error without being many times
// it.
TEST(BackgroundUncertainty, CoversTheErrorOfALongTail) {
  for (const double slope : {0.0, 0.1}) {
    const Measured m = measured({true, slope, 0});
    EXPECT_GT(m.truePct, 0.5) << "the fault that is pointed out";
    EXPECT_GT(m.saidPct, 0.7 * m.truePct) << slope;
    EXPECT_LT(m.saidPct, 4 * m.truePct) << slope;
  }
}

TEST(BackgroundUncertainty, IsSmallUnderAGaussianLobe) {
  for (const double slope : {0.0, 0.1}) {
    const Measured m = measured({false, slope, 0});
    EXPECT_LT(m.truePct, 0.05);
    EXPECT_LT(m.saidPct, 0.1) << slope;
  }
}

// With noise both tails explain the surroundings: what they differ by is then honest doubt, also under a Gaussian lobe.
TEST(BackgroundUncertainty, NoiseLeavesDoubt) {
  const Measured m = measured({true, 0.05, 0.02});
  EXPECT_GT(m.saidPct, 0.5 * m.truePct);
  EXPECT_TRUE(std::isfinite(measured({false, 0.05, 0.02}).saidPct));
}

TEST(BackgroundUncertainty, NothingToLookAtSaysNothing) {
  const Image image = imageOf({true, 0, 0});
  Footprint footprint;
  footprint.centre = Pixel(119.5, 118.25);
  footprint.shape = Eigen::Matrix2d::Identity() * kRadius * kRadius;
  EXPECT_EQ(backgroundUncertaintyPct(image, std::vector<char>(image.data.size(), 0), footprint, kPeak), 0);
  EXPECT_EQ(backgroundUncertaintyPct(image, std::vector<char>(image.data.size(), 1), footprint, 0), 0);
}

}  // namespace
}  // namespace glint
