// SPDX-License-Identifier: BSD-3-Clause
#include "core/light/left_out.h"

#include <gtest/gtest.h>

#include <limits>

namespace glint {
namespace {

struct PlacedCamera {
  Eigen::Vector3d centre;
  Eigen::Vector3d centreInWorld() const { return centre; }
};
struct PlacedView {
  PlacedCamera camera;
  const int* surface = nullptr;
};

constexpr int kTable = 0, kVase = 0;

TEST(PlacesOf, ViewsFromOnePlaceShareANumber) {
  for (const double scale : {1e-6, 1.0, 1e6}) {
    const auto at = [&](double x, const int* surface) { return PlacedView{{scale * Eigen::Vector3d(x, 0, 1)}, surface}; };
    const std::vector<PlacedView> views{at(0, &kTable), at(1, &kTable), at(0, &kTable), at(3, &kTable), at(1, &kTable)};
    const std::vector<int> expected{0, 1, 0, 2, 1};
    EXPECT_EQ(placesOf(views), expected) << scale;
    EXPECT_EQ(countOf(expected), 3);
  }
}

// An object on a turntable before a camera that stands: its frames have other surfaces and are other observations.
TEST(PlacesOf, AnotherSurfaceIsAnotherPlace) {
  const PlacedCamera camera{{0, 0, 1}};
  const std::vector<PlacedView> views{{camera, &kTable}, {camera, &kVase}, {camera, &kTable}};
  EXPECT_EQ(placesOf(views), (std::vector<int>{0, 1, 0}));
}

// Poses that were written with twelve digits are one place; steps of a millimetre in a room are not.
TEST(PlacesOf, RoundingIsNoStep) {
  const auto at = [](double x) { return PlacedView{{{x, 2, -1}}, &kTable}; };
  EXPECT_EQ(placesOf(std::vector{at(0), at(5), at(1e-12), at(5 - 1e-12)}), (std::vector<int>{0, 1, 0, 1}));
  EXPECT_EQ(placesOf(std::vector{at(0), at(5), at(1e-3)}), (std::vector<int>{0, 1, 2}));
}

TEST(PlacesOf, Degenerate) {
  EXPECT_TRUE(placesOf(std::vector<PlacedView>{}).empty());
  EXPECT_EQ(countOf({}), 0);
  EXPECT_TRUE(placesToLeaveOut({}, 6).empty());
  const auto at = [](double x) { return PlacedView{{{x, x, x}}, nullptr}; };
  EXPECT_EQ(placesOf(std::vector{at(7)}), std::vector<int>{0});
  EXPECT_EQ(placesOf(std::vector{at(7), at(7)}), (std::vector<int>{0, 0}));
  // A centre that is not a number is nobody's neighbour.
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(countOf(placesOf(std::vector{at(nan), at(nan), at(1)})), 3);
}

TEST(PlacesToLeaveOut, AreEvenlySpread) {
  EXPECT_EQ(placesToLeaveOut({0, 1, 2, 0, 1, 2}, 6), (std::vector<int>{0, 1, 2}));
  EXPECT_EQ(placesToLeaveOut({0, 1, 2, 3, 4, 5, 6, 7}, 4), (std::vector<int>{0, 2, 4, 6}));
}

}  // namespace
}  // namespace glint
