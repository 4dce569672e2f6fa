// SPDX-License-Identifier: BSD-3-Clause
// The fall of a highlight, against lobes in closed form.
#include "core/retexture/fall_profile.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "core/retexture/appearance.h"

namespace glint::fall_profile_tests {

/// A Gaussian lobe that is half its peak on the contour.
double gaussian(double rho) { return std::pow(0.5, rho * rho); }

/// Samples over the plane, as pixels are: their number goes with rho. @param unit  of the values; 1 = on the contour.
std::vector<FallProfile::Sample> gaussianSamples(double from, double unit = 1, double noise = 0, unsigned seed = 1) {
  std::vector<FallProfile::Sample> samples;
  std::mt19937 random(seed);
  std::normal_distribution<double> error(0, noise > 0 ? noise : 1);
  constexpr double kPixel = 1.0 / 20;  // a contour of 20 px radius
  for (double y = -4; y <= 4; y += kPixel)
    for (double x = -4; x <= 4; x += kPixel) {
      const double rho = std::hypot(x, y);
      if (rho >= from && rho < 4) samples.push_back({rho, unit * (2 * gaussian(rho) + (noise > 0 ? error(random) : 0))});
    }
  return samples;
}

double worst(const FallProfile& profile) {
  double most = 0;
  for (double rho = 0; rho < 3.3; rho += 0.01) most = std::max(most, std::abs(profile.at(rho) - gaussian(rho)));
  return most;
}

TEST(FallProfile, Nominal) {
  const Outcome<FallProfile> p = FallProfile::learn(gaussianSamples(0));
  ASSERT_TRUE(p);
  EXPECT_LT(worst(*p), 0.012);  // measured 0.008: a step of rho is 0.05
  EXPECT_NEAR(p->peakOverContour(), 2, 0.01);
  EXPECT_EQ(p->observedFrom(), 0);
  EXPECT_EQ(p->at(0), 1);
  EXPECT_EQ(p->at(FallProfile::kEnd), 0);
  EXPECT_NEAR(p->beforeEnd(), gaussian(3.425), 1e-4);
  for (double rho = 0; rho < 4.2; rho += 0.003) EXPECT_GE(p->at(rho), p->at(rho + 0.003)) << rho;
}

TEST(FallProfile, Scale) {
  const Outcome<FallProfile> one = FallProfile::learn(gaussianSamples(0));
  ASSERT_TRUE(one);
  for (const double unit : {1e-12, 1e12}) {
    const Outcome<FallProfile> p = FallProfile::learn(gaussianSamples(0, unit));
    ASSERT_TRUE(p);
    EXPECT_NEAR(p->peakOverContour() / unit, one->peakOverContour(), 1e-9);
    for (double rho = 0; rho < 4; rho += 0.1) EXPECT_NEAR(p->at(rho), one->at(rho), 1e-12);
  }
}

TEST(FallProfile, Noise) {
  std::vector<double> errors;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const Outcome<FallProfile> p = FallProfile::learn(gaussianSamples(0, 1, 0.05, seed));
    ASSERT_TRUE(p);
    errors.push_back(worst(*p));
  }
  std::sort(errors.begin(), errors.end());
  EXPECT_LT(errors[10], 0.05);  // single pixels are off by 2.5 % of the peak; the innermost step has a few of them
}

TEST(FallProfile, AClippedCoreIsContinuedAndSaidSo) {
  const Outcome<FallProfile> p = FallProfile::learn(gaussianSamples(0.6));
  ASSERT_TRUE(p);
  EXPECT_NEAR(p->observedFrom(), 0.6, 0.051);
  EXPECT_NEAR(p->peakOverContour(), 2, 0.04);
  EXPECT_LT(worst(*p), 0.02);
}

TEST(FallProfile, Degenerate) {
  const auto reason = [](const std::vector<FallProfile::Sample>& samples) {
    const Outcome<FallProfile> p = FallProfile::learn(samples);
    return p ? std::string("an answer") : std::string(nameOf(p.failure().reason));
  };
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(reason({}), nameOf(Reason::TooFewPoints));
  EXPECT_EQ(reason(std::vector<FallProfile::Sample>(100, {nan, 1})), nameOf(Reason::TooFewPoints));
  EXPECT_EQ(reason(std::vector<FallProfile::Sample>(100, {0.5, infinity})), nameOf(Reason::TooFewPoints));
  EXPECT_EQ(reason(gaussianSamples(1.5)), nameOf(Reason::TooFewPoints));  // nothing inside
  EXPECT_EQ(reason(std::vector<FallProfile::Sample>(100, {0.5, 1})), nameOf(Reason::NoHighlight));
  std::vector<FallProfile::Sample> rising = gaussianSamples(0), below = rising;
  for (FallProfile::Sample& s : rising) s.value = s.rho;
  for (FallProfile::Sample& s : below) s.value = -1;
  EXPECT_EQ(reason(rising), nameOf(Reason::NoHighlight));
  EXPECT_EQ(reason(below), nameOf(Reason::NoHighlight));
  std::vector<FallProfile::Sample> flat = gaussianSamples(0.9);  // clipped, and a plateau around it
  for (FallProfile::Sample& s : flat)
    if (s.rho < 1.4) s.value = 1;
  EXPECT_EQ(reason(flat), nameOf(Reason::NoHighlight));
  std::vector<FallProfile::Sample> mixed = gaussianSamples(0);
  mixed.insert(mixed.end(), 50, {0.02, nan});
  const Outcome<FallProfile> p = FallProfile::learn(mixed);
  ASSERT_TRUE(p);
  EXPECT_LT(worst(*p), 0.012);
}

Polyline ellipseLine(double a, double b, const Pixel& centre) {
  Polyline line;
  for (int i = 0; i < 400; ++i)
    line.points.push_back(centre + Pixel(a * std::cos(2 * M_PI * i / 400), b * std::sin(2 * M_PI * i / 400)));
  return line;
}

TEST(ContourStar, IsTheRadiusOfAnEllipseInItsOwnUnits) {
  for (const double scale : {1.0, 100.0}) {
    const Pixel centre(30, -7);
    const Outcome<ContourStar> star = ContourStar::of(ellipseLine(9 * scale, 4 * scale, centre), centre);
    ASSERT_TRUE(star);
    for (const Pixel& d : {Pixel(3, 1), Pixel(-2, 5), Pixel(0.1, -0.2), Pixel(14, 0), Pixel(5, -0.001)})
      EXPECT_NEAR(star->rho(centre + scale * d), std::hypot(d.x() / 9, d.y() / 4), 2e-3) << d.transpose();
    EXPECT_EQ(star->rho(centre), 0);
  }
}

TEST(ContourStar, KnowsItsGapsAndItsMiddle) {
  const Polyline line = ellipseLine(10, 10, {0, 0});
  const Outcome<ContourStar> star = ContourStar::of(line, Pixel(100, 0), {{390, 10}});  // 9 degrees both sides of +x
  ASSERT_TRUE(star);  // around the centroid: the place given lies outside
  EXPECT_NEAR(star->rho(Pixel(5, 0)), 0.5, 1e-3);
  EXPECT_TRUE(star->inGap(Pixel(20, 1)));
  EXPECT_TRUE(star->inGap(Pixel(20, -1)));
  EXPECT_FALSE(star->inGap(Pixel(20, 8)));
  EXPECT_FALSE(star->inGap(Pixel(-20, 0)));
}

TEST(ContourStar, Degenerate) {
  EXPECT_FALSE(ContourStar::of({}, Pixel(0, 0)));
  EXPECT_FALSE(ContourStar::of({{{0, 0}, {5, 0}}}, Pixel(0, 0)));
  EXPECT_FALSE(ContourStar::of({{{0, 0}, {5, 0}, {9, 0}}}, Pixel(1, 0)));
  const double nan = std::nan("");
  EXPECT_FALSE(ContourStar::of({{{nan, nan}, {5, nan}, {9, 0}}}, Pixel(1, 0)));
}

}  // namespace glint::fall_profile_tests
