// SPDX-License-Identifier: BSD-3-Clause
#include "core/surface/level_set.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/tolerances.h"

namespace glint {
namespace {

constexpr double kPi = std::numbers::pi;

TEST(LevelSet, DiscHasItsAreaItsOrientationAndPolishedVertices) {
  const Pixel centre(200.3, 150.7);
  const PixelField field = [&](const Pixel& p) { return std::optional<double>((p - centre).norm()); };
  for (const double radius : {1.5, 5.0, 30.0, 120.0}) {
    LevelSetOptions options;
    options.seeds = {centre};
    const auto found = traceLevelSets(field, {}, radius, 640, 480, options);
    ASSERT_EQ(found.size(), 1u) << radius;
    for (std::size_t i = 0; i < found[0].outline.points.size(); ++i) {
      EXPECT_NEAR((found[0].outline.points[i] - centre).norm(), radius, 1e-9);
      EXPECT_EQ(found[0].onBorder[i], 0);
    }
    // The polygon is inside the disc by at most the sagitta: 0 < missing area < 2 pi r s.
    const double missing = kPi * radius * radius - signedArea(found[0].outline);
    EXPECT_GT(missing, 0);
    EXPECT_LT(missing, 2 * kPi * radius * options.sagittaPx);
    EXPECT_LT(found[0].minimum, radius);
  }
}

TEST(LevelSet, SmallHighlightIsFoundFromItsSeedOnly) {
  const Pixel centre(201.9, 149.9);  // between the nodes of the 4 px grid
  const PixelField field = [&](const Pixel& p) { return std::optional<double>((p - centre).norm()); };
  LevelSetOptions options;
  options.seeds = {centre + Pixel(0.3, 0.2)};
  const auto found = traceLevelSets(field, {}, 0.5, 640, 480, options);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR(signedArea(found[0].outline), kPi * 0.25, 2e-3);
}

TEST(LevelSet, ThinSlantedBandIsOnePiece) {
  const Pixel centre(320, 240), along(std::cos(0.4), std::sin(0.4)), across(-along.y(), along.x());
  const PixelField field = [&](const Pixel& p) {
    const Pixel d = p - centre;
    return std::optional<double>(std::hypot(d.dot(along) / 60, d.dot(across) / 1.5));
  };
  LevelSetOptions options;
  options.seeds = {centre};
  const auto found = traceLevelSets(field, {}, 1.0, 640, 480, options);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR(signedArea(found[0].outline), kPi * 60 * 1.5, 0.2);
}

TEST(LevelSet, TwoBlobsMergeOrStayApartAsTheFieldSays) {
  // Cassini ovals |p - a||p - b| = level^2, foci at distance 2 c: one piece for level > c, two for level < c.
  const Pixel a(290.2, 230.1), b(340.7, 251.9);
  const double c = 0.5 * (a - b).norm();
  const PixelField field = [&](const Pixel& p) { return std::optional<double>(std::sqrt((p - a).norm() * (p - b).norm())); };
  LevelSetOptions options;
  options.seeds = {a, b};
  EXPECT_EQ(traceLevelSets(field, {}, c * 1.02, 640, 480, options).size(), 1u);
  EXPECT_EQ(traceLevelSets(field, {}, c * 0.98, 640, 480, options).size(), 2u);
}

TEST(LevelSet, DomainBorderIsMarkedAndExact) {
  // A half disc: the field ends at x = 300.25. And a quarter disc in the image corner.
  const PixelField half = [](const Pixel& p) {
    return p.x() > 300.25 ? std::nullopt : std::optional<double>((p - Pixel(300.25, 200)).norm());
  };
  const auto found = traceLevelSets(half, {}, 25, 640, 480);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR(signedArea(found[0].outline), kPi * 25 * 25 / 2, 0.1);
  int border = 0;
  for (std::size_t i = 0; i < found[0].onBorder.size(); ++i) {
    const Pixel& p = found[0].outline.points[i];
    if (!found[0].onBorder[i]) {
      EXPECT_NEAR((p - Pixel(300.25, 200)).norm(), 25, 1e-8);
      continue;
    }
    ++border;
    EXPECT_NEAR(p.x(), 300.25, 1e-8);
  }
  EXPECT_GT(border, 2);
  const PixelField corner = [](const Pixel& p) { return std::optional<double>((p - Pixel(-0.5, -0.5)).norm()); };
  const auto quarter = traceLevelSets(corner, {}, 40, 640, 480);
  ASSERT_EQ(quarter.size(), 1u);
  EXPECT_NEAR(signedArea(quarter[0].outline), kPi * 1600 / 4, 0.1);
}

TEST(LevelSet, AnnulusGivesItsOuterOutlineOnly) {
  const Pixel centre(320, 240);
  const PixelField field = [&](const Pixel& p) { return std::optional<double>(std::abs((p - centre).norm() - 50)); };
  const auto found = traceLevelSets(field, {}, 12, 640, 480);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR(signedArea(found[0].outline), kPi * 62 * 62, 0.3);
}

TEST(LevelSet, RoughBatchDoesNotMoveTheVertices) {
  const Pixel centre(320, 240);
  const PixelField field = [&](const Pixel& p) { return std::optional<double>((p - centre).norm()); };
  const PixelFieldBatch rough = [&](const std::vector<Pixel>& ps) {
    std::vector<std::optional<double>> v;
    for (const Pixel& p : ps) v.push_back((p - centre).norm() + 0.05 * std::sin(37 * p.x() + 11 * p.y()));
    return v;
  };
  const auto found = traceLevelSets(field, rough, 28, 640, 480);  // nodes at distance 28 exactly: on the level
  ASSERT_EQ(found.size(), 1u);
  for (const Pixel& p : found[0].outline.points) EXPECT_NEAR((p - centre).norm(), 28, 1e-8);
}

TEST(LevelSet, DegenerateFields) {
  EXPECT_TRUE(traceLevelSets([](const Pixel&) { return std::optional<double>(); }, {}, 1, 64, 48).empty());
  EXPECT_TRUE(traceLevelSets([](const Pixel&) { return std::optional<double>(2); }, {}, 1, 64, 48).empty());
  EXPECT_TRUE(traceLevelSets([](const Pixel&) { return std::optional<double>(std::nan("")); }, {}, 1, 64, 48).empty());
  const auto all = traceLevelSets([](const Pixel&) { return std::optional<double>(0); }, {}, 1, 64, 48);
  ASSERT_EQ(all.size(), 1u);  // the whole image
  EXPECT_NEAR(signedArea(all[0].outline), 64 * 48, 1e-2);
  for (const char b : all[0].onBorder) EXPECT_EQ(b, 1);
  EXPECT_THROW(traceLevelSets({}, {}, 1, 64, 48), std::invalid_argument);
  LevelSetOptions bad;
  bad.gridStepPx = 0;
  EXPECT_THROW(traceLevelSets([](const Pixel&) { return std::optional<double>(0); }, {}, 1, 64, 48, bad), std::invalid_argument);
}

}  // namespace
}  // namespace glint
