// SPDX-License-Identifier: BSD-3-Clause
// Pixels whose radiance is written out here from the lobes' papers, so that lobe and width are known.
#include "core/advise/lobe_comparison.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

namespace glint {
namespace lobe_comparison_tests {

constexpr double kTypical = 0.1;  // m
constexpr double kHeight = 3, kDistance = 2;

/// Walter et al. 2007: Smith's masking for Beckmann in its height-correlated form.
double beckmannLambda(double m, double tangent) {
  if (!(tangent > 0)) return 0;
  const double a = 1 / (m * tangent);
  return (std::erf(a) - 1) / 2 + std::exp(-a * a) / (2 * a * std::sqrt(std::numbers::pi));
}
double ggxLambda(double m, double tangent) { return (std::sqrt(1 + m * m * tangent * tangent) - 1) / 2; }

/// A camera at 20 degrees, the light at the mirror angle turned by up to 0.35 rad in and across the plane of incidence.
std::vector<LobePixel> pixels(Lobe lobe, double m, double noise = 0, double unit = 1, double offset = 0) {
  std::vector<LobePixel> result;
  std::mt19937 engine(11);
  std::normal_distribution<double> gauss(0, 1);
  double most = 0;
  std::vector<double> radiance;
  for (int i = -14; i <= 14; ++i)
    for (int j = -14; j <= 14; ++j) {
      if (i * i + j * j > 14 * 14) continue;
      LobePixel p;
      p.normal = Eigen::Vector3d::UnitZ();
      p.toCamera = Eigen::Vector3d(std::sin(0.35), 0, std::cos(0.35));
      const double a = -0.35 + 0.025 * i, b = 0.025 * j;
      p.toLight = Eigen::Vector3d(std::sin(a) * std::cos(b), std::sin(b), std::cos(a) * std::cos(b));
      p.distance = unit * kDistance * (1 + 0.01 * i);
      const Eigen::Vector3d h = (p.toLight + p.toCamera).normalized();
      p.alpha = std::atan2(h.head<2>().norm(), h.z());
      const double c = h.z(), t = std::tan(p.alpha), v = p.toCamera.z();
      const double tv = std::tan(std::acos(v)), tl = std::tan(std::acos(p.toLight.z()));
      double s = 0;
      const Eigen::Vector3d mirrored(-p.toLight.x(), -p.toLight.y(), p.toLight.z());
      if (lobe == Lobe::Phong) s = std::pow(std::max(0.0, mirrored.dot(p.toCamera)), 1 / (2 * m * m));
      if (lobe == Lobe::BlinnPhong) s = std::pow(c, 2 / (m * m));
      if (lobe == Lobe::TorranceSparrow)
        s = std::exp(-t * t / (m * m)) / std::pow(c, 4) / (1 + beckmannLambda(m, tv) + beckmannLambda(m, tl)) / v;
      if (lobe == Lobe::Ggx) s = 1 / std::pow(c, 4) / std::pow(m * m + t * t, 2) / (1 + ggxLambda(m, tv) + ggxLambda(m, tl)) / v;
      s /= p.distance * p.distance;
      most = std::max(most, s);
      radiance.push_back(s);
      result.push_back(p);
    }
  for (std::size_t i = 0; i < result.size(); ++i)
    result[i].radiance = kHeight * (radiance[i] / most + offset + noise * gauss(engine));
  return result;
}

LobeComparison compared(std::vector<LobePixel> of) {
  LobeSamples samples;
  samples.pixels = std::move(of);
  const Outcome<LobeComparison> c = compareLobes(samples);
  if (!c) throw std::runtime_error(c.failure().message());
  return *c;
}

const LobeMatch& matchOf(const LobeComparison& c, Lobe lobe) {
  return *std::find_if(c.matches.begin(), c.matches.end(), [&](const LobeMatch& m) { return m.lobe == lobe; });
}

const Lobe kAll[] = {Lobe::Phong, Lobe::BlinnPhong, Lobe::TorranceSparrow, Lobe::Ggx};

TEST(LobeComparison, FindsTheLobeThatMadeThePixelsAndItsWidth) {
  for (const Lobe lobe : kAll) {
    const LobeComparison c = compared(pixels(lobe, kTypical));
    ASSERT_GE(c.best, 0);
    EXPECT_EQ(c.matches[std::size_t(c.best)].lobe, lobe) << nameOf(lobe);
    const LobeMatch& own = matchOf(c, lobe);
    EXPECT_NEAR(own.m, kTypical, 1e-5) << nameOf(lobe);
    EXPECT_LT(own.rmsPct, 1e-3);
    EXPECT_NEAR(own.offsetPct, 0, 1e-3);
    ASSERT_EQ(own.profile.size(), c.measured.size());
    for (std::size_t i = 0; i < own.profile.size(); ++i) EXPECT_NEAR(own.profile[i], c.measured[i].mean, 1e-5);
    for (const LobeMatch& other : c.matches)
      if (other.lobe != lobe) {
        EXPECT_FALSE(other.asGood);
        EXPECT_GT(other.rmsPct, 10 * own.rmsPct) << nameOf(other.lobe) << " on " << nameOf(lobe);
      }
  }
  // GGX has the long tail: the others cannot follow it.
  EXPECT_GT(matchOf(compared(pixels(Lobe::Ggx, kTypical)), Lobe::TorranceSparrow).rmsPct, 1);
}

TEST(LobeComparison, NeitherUnitNorBrightnessNorAConstantMatters) {
  const LobeComparison one = compared(pixels(Lobe::Ggx, kTypical));
  std::vector<LobePixel> bright = pixels(Lobe::Ggx, kTypical, 0, 1000, 0.05);
  for (LobePixel& p : bright) p.radiance *= 1e4;
  const LobeComparison other = compared(bright);
  for (const Lobe lobe : kAll) {
    EXPECT_NEAR(matchOf(other, lobe).m / matchOf(one, lobe).m, 1, 1e-5);
    EXPECT_NEAR(matchOf(other, lobe).rmsPct, matchOf(one, lobe).rmsPct, 1e-3);
    EXPECT_NEAR(matchOf(other, lobe).offsetPct - matchOf(one, lobe).offsetPct, 5, 0.01);
  }
}

TEST(LobeComparison, SaysWhatTheNoiseHides) {
  // Noise of 0.2 % of the peak is the residual of the right lobe; at 20 % nobody tells Blinn-Phong from Beckmann.
  const LobeComparison little = compared(pixels(Lobe::Ggx, kTypical, 0.002));
  EXPECT_EQ(little.matches[std::size_t(little.best)].lobe, Lobe::Ggx);
  EXPECT_NEAR(matchOf(little, Lobe::Ggx).rmsPct, 0.2, 0.02);
  EXPECT_NEAR(matchOf(little, Lobe::Ggx).m, kTypical, 0.01 * kTypical);
  EXPECT_FALSE(matchOf(little, Lobe::TorranceSparrow).asGood);
  const LobeComparison much = compared(pixels(Lobe::TorranceSparrow, kTypical, 0.2));
  EXPECT_TRUE(matchOf(much, Lobe::BlinnPhong).asGood);
  EXPECT_TRUE(much.matches[std::size_t(much.best)].asGood);
  for (const LobeComparison::Bin& bin : much.measured)
    if (bin.pixels > 20) {
      EXPECT_NEAR(bin.spread, 0.2, 0.1);
    }
}

/// Three standard deviations of one number: chi squared of a lobe, in units of the best one's noise, is at most 9 above that of
/// the best.
TEST(LobeComparison, AsGoodIsWithinThreeStandardDeviations) {
  int near = 0;
  for (const double noise : {0.05, 0.06, 0.08, 0.1, 0.12, 0.15, 0.2, 0.3}) {
    const LobeComparison c = compared(pixels(Lobe::TorranceSparrow, kTypical, noise));
    const double best = c.matches[std::size_t(c.best)].rmsPct;
    for (const LobeMatch& m : c.matches) {
      if (m.failure) continue;
      const double above = c.pixels * (std::pow(m.rmsPct / best, 2) - 1);
      EXPECT_EQ(m.asGood, above < 9) << nameOf(m.lobe) << ", noise " << noise << ": " << above;
      near += above > 9 && above < 18;
    }
  }
  EXPECT_GT(near, 0) << "some must lie near the bound, or this tells nothing";
}

/// The pixels of pixels() as a grid: 29 x 29 cells, 2 px apart.
LobeGrid gridOf(const std::vector<LobePixel>& of) {
  LobeGrid grid{Pixel(100, 50), 2, 29, 29, {}};
  grid.places.resize(29 * 29);
  std::size_t next = 0;
  for (int i = -14; i <= 14; ++i)
    for (int j = -14; j <= 14; ++j)
      if (i * i + j * j <= 14 * 14) grid.places[std::size_t((j + 14) * 29 + i + 14)] = of[next++];
  return grid;
}

TEST(LobeComparison, ItsContoursLieWhereTheRadianceHasTheLevel) {
  constexpr double kLevel = 0.5;
  constexpr double kLinearPct = 3;  // of the peak: linear between cells, across which the radiance falls by up to a fifth of it
  for (const Lobe lobe : kAll) {
    const std::vector<LobePixel> of = pixels(lobe, kTypical);
    const LobeComparison c = compared(of);
    const LobeGrid grid = gridOf(of);
    const std::vector<Polyline> lines = lobeContours(grid, matchOf(c, lobe), kLevel);
    ASSERT_EQ(lines.size(), 1u) << nameOf(lobe);
    EXPECT_TRUE(lines[0].closed);
    for (const Pixel& p : lines[0].points) {
      // Stored pixels, back to cells; the radiance written out above, linear between the two cells that the point lies between.
      const Eigen::Vector2d cell = (p - grid.first) / grid.step;
      const int x0 = int(std::floor(cell.x())), y0 = int(std::floor(cell.y()));
      const int x1 = int(std::ceil(cell.x())), y1 = int(std::ceil(cell.y()));
      const auto radiance = [&](int x, int y) { return grid.places.at(std::size_t(y * 29 + x)).value().radiance / kHeight; };
      const double t = (cell - Eigen::Vector2d(x0, y0)).sum();
      EXPECT_NEAR((1 - t) * radiance(x0, y0) + t * radiance(x1, y1), kLevel, kLinearPct / 100) << nameOf(lobe);
    }
  }
}

/// What the background adds to the highlight belongs to the curves and contours that lie over the measured ones.
TEST(LobeComparison, AConstantIsInProfilesAndContours) {
  constexpr double kOffset = 0.1, kLevel = 0.5;
  const std::vector<LobePixel> lit = pixels(Lobe::Ggx, kTypical, 0, 1, kOffset), bare = pixels(Lobe::Ggx, kTypical);
  const LobeComparison c = compared(lit), without = compared(bare);
  const LobeMatch& own = matchOf(c, Lobe::Ggx);
  ASSERT_EQ(own.profile.size(), c.measured.size());
  for (std::size_t i = 0; i < own.profile.size(); ++i) EXPECT_NEAR(own.profile[i], c.measured[i].mean, 1e-5);
  const std::vector<Polyline> lines = lobeContours(gridOf(lit), own, kLevel);
  const std::vector<Polyline> same = lobeContours(gridOf(bare), matchOf(without, Lobe::Ggx), kLevel - kOffset);
  ASSERT_EQ(lines.size(), 1u);
  ASSERT_EQ(same.size(), 1u);
  EXPECT_NEAR(signedArea(lines[0]) / signedArea(same[0]), 1, 1e-4);
}

TEST(LobeComparison, ItsContoursEndWhereTheSamplesDo) {
  const std::vector<LobePixel> of = pixels(Lobe::Ggx, kTypical);
  const LobeComparison c = compared(of);
  const LobeMatch& ggx = matchOf(c, Lobe::Ggx);
  LobeGrid grid = gridOf(of);
  for (int y = 0; y < 29; ++y)
    for (int x = 0; x <= 14; ++x) grid.places[std::size_t(y * 29 + x)].reset();  // half of the highlight lies beside the surface
  const std::vector<Polyline> lines = lobeContours(grid, ggx, 0.5);
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_FALSE(lines[0].closed);
  for (const Pixel& p : lines[0].points) EXPECT_GE(p.x(), grid.first.x() + 15 * grid.step);
  EXPECT_TRUE(lobeContours(grid, ggx, 2).empty());  // above the peak
  LobeMatch failed = ggx;
  failed.failure = Failure{Reason::NotConverged, ""};
  EXPECT_TRUE(lobeContours(grid, failed, 0.5).empty());
  EXPECT_TRUE(lobeContours({}, ggx, 0.5).empty());
}

TEST(LobeComparison, SaysWhyThereIsNone) {
  LobeSamples few;
  few.pixels = pixels(Lobe::Ggx, kTypical);
  few.pixels.resize(20);
  few.clipped = 300;
  EXPECT_EQ(compareLobes(few).failure().reason, Reason::TooFewPoints);
  LobeSamples level;
  level.pixels = pixels(Lobe::Ggx, kTypical);
  for (LobePixel& p : level.pixels) p.radiance = 1;
  EXPECT_FALSE(compareLobes(level));
  LobeSamples rising;
  rising.pixels = pixels(Lobe::Ggx, kTypical);
  for (LobePixel& p : rising.pixels) p.radiance = -p.radiance;
  const auto none = compareLobes(rising);
  ASSERT_FALSE(none);
  EXPECT_EQ(none.failure().reason, Reason::NotConverged);
}

}  // namespace lobe_comparison_tests
}  // namespace glint
