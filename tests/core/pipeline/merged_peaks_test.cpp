// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/merged_peaks.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/surface/analytic.h"

/// Patches with hills at known places, and views with them.
namespace glint::merged_peaks_tests {
namespace {

constexpr int kSide = 60;

Polyline circle(double radius) {
  Polyline line;
  for (int i = 0; i < 48; ++i)
    line.points.push_back(Pixel(kSide / 2, kSide / 2) + radius * Pixel(std::cos(i * M_PI / 24), std::sin(i * M_PI / 24)));
  return line;
}

/// Hills of so many lamps on a ring of 12 px about the middle, each with this standard deviation, on a floor.
PixelPatch hills(int count, double sigma, double noise = 0, double brightness = 1) {
  PixelPatch patch;
  patch.camera.width = patch.camera.height = kSide;
  patch.columns = patch.rows = kSide;
  patch.used.assign(kSide * kSide, 1);
  std::mt19937 random(1);
  std::normal_distribution<double> normal(0, noise > 0 ? noise : 1);
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      double sum = 0.3;
      for (int k = 0; k < count; ++k) {
        const double a = 0.3 + 2 * M_PI * k / count, dx = x - kSide / 2 - 12 * std::cos(a), dy = y - kSide / 2 - 12 * std::sin(a);
        sum += std::exp(-(dx * dx + dy * dy) / (2 * sigma * sigma));
      }
      patch.value.push_back(float(brightness * (sum + (noise > 0 ? normal(random) : 0))));
    }
  return patch;
}

TEST(PeaksInside, CountsHillsWithValleysBetweenThem) {
  for (const int count : {1, 2, 4, 6}) EXPECT_EQ(peaksInside(hills(count, 4), circle(20)), count);
  EXPECT_EQ(peaksInside(hills(6, 9), circle(20)), 1) << "merged to one top";
}

TEST(PeaksInside, BrightnessDoesNotMatter) {
  for (const double scale : {1e-3, 1e3}) EXPECT_EQ(peaksInside(hills(6, 4, 0, scale), circle(20)), 6);
}

TEST(PeaksInside, NoiseMakesNoPeaks) {
  for (const int count : {1, 6}) EXPECT_EQ(peaksInside(hills(count, 4, 0.03), circle(20)), count);
}

TEST(PeaksInside, Degenerate) {
  EXPECT_EQ(peaksInside(hills(0, 4), circle(20)), 1) << "a plateau";
  EXPECT_EQ(peaksInside(hills(2, 4), circle(0.1)), 1) << "one cell";
  PixelPatch blind = hills(2, 4);
  blind.used.assign(blind.size(), 0);
  EXPECT_EQ(peaksInside(blind, circle(20)), 0);
}

std::vector<TrainingView> viewsOf(int peaks, int views, bool clipped = false) {
  AnalyticSpec spec;
  spec.type = "sphere";
  spec.radius = 0.3;
  const std::shared_ptr<const Surface> surface = makeAnalytic(spec);
  std::vector<TrainingView> all;
  for (int i = 0; i < views; ++i) {
    TrainingView v;
    v.surface = surface;
    v.highlight.contour = circle(20);
    v.highlight.clipped = clipped;
    v.pixels = std::make_shared<PixelPatch>(hills(peaks, 4));
    all.push_back(std::move(v));
  }
  return all;
}

TEST(MergedPeaks, SixAreNamedTwoAreADoubtOneIsALamp) {
  const std::optional<MergedPeaks> six = mergedPeaks(viewsOf(6, 3), std::nullopt, Settings{});
  ASSERT_TRUE(six);
  EXPECT_TRUE(six->certain);
  EXPECT_NE(six->text.find("up to 6 peaks lie inside one contour in 3 of 3 training frames"), std::string::npos) << six->text;
  const std::optional<MergedPeaks> two = mergedPeaks(viewsOf(2, 3), std::nullopt, Settings{});
  ASSERT_TRUE(two);
  EXPECT_FALSE(two->certain);
  EXPECT_FALSE(mergedPeaks(viewsOf(1, 3), std::nullopt, Settings{}));
  EXPECT_FALSE(mergedPeaks(viewsOf(6, 1), std::nullopt, Settings{}));
  EXPECT_FALSE(mergedPeaks(viewsOf(6, 3, true), std::nullopt, Settings{}));
  EXPECT_FALSE(mergedPeaks({}, std::nullopt, Settings{}));
  std::vector<TrainingView> few = viewsOf(1, 4);
  few[0].pixels = viewsOf(6, 1)[0].pixels;
  few[1].pixels = few[0].pixels;
  EXPECT_FALSE(mergedPeaks(few, std::nullopt, Settings{}));
}

}  // namespace
}  // namespace glint::merged_peaks_tests
