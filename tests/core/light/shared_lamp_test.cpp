// SPDX-License-Identifier: BSD-3-Clause
#include "core/light/shared_lamp.h"

#include <gtest/gtest.h>

#include <cmath>

namespace glint {
namespace {

ReflectedRay towards(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  const Eigen::Vector3d d = (to - from).normalized();
  return {from, d, d};
}

/// Eight places on a ball; a second reflection stands before the lamp's in every other view.
std::vector<std::vector<ReflectedRay>> viewsOf(const Eigen::Vector3d& lamp) {
  std::vector<std::vector<ReflectedRay>> views;
  for (int i = 0; i < 8; ++i) {
    const Eigen::Vector3d at(std::cos(i), std::sin(i), 0.3 * i), window(-3 - i, 5 - 2.0 * i * i, 1);
    views.emplace_back();
    if (i % 2) views.back().push_back(towards(at, window));
    views.back().push_back(towards(at, lamp));
  }
  return views;
}

TEST(SharedLamp, IsFoundBesideOtherReflections) {
  const Eigen::Vector3d lamp(4, -3, 6);
  const std::optional<SharedLamp> found = sharedLamp(viewsOf(lamp));
  ASSERT_TRUE(found);
  EXPECT_LT((found->light.position() - lamp).norm(), 1e-6);
  EXPECT_LT(found->miss, 1e-6);
  EXPECT_EQ(found->chosen, (std::vector<int>{0, 1, 0, 1, 0, 1, 0, 1}));
}

TEST(SharedLamp, FarAway) {
  std::vector<std::vector<ReflectedRay>> views = viewsOf({4, -3, 6});
  for (std::vector<ReflectedRay>& rays : views) rays.back().direction = Eigen::Vector3d(1, 2, 2) / 3;
  const std::optional<SharedLamp> found = sharedLamp(views);
  ASSERT_TRUE(found);
  EXPECT_LT((found->light.directionFrom({0, 0, 0}) - Eigen::Vector3d(1, 2, 2) / 3).norm(), 1e-6);
}

/// One view in four may show something else, or nothing; with more of them the miss tells.
TEST(SharedLamp, ViewsWithoutARay) {
  std::vector<std::vector<ReflectedRay>> views = viewsOf({4, -3, 6});
  views[2].clear();
  std::optional<SharedLamp> found = sharedLamp(views);
  ASSERT_TRUE(found);
  EXPECT_LT(found->miss, 1e-6);
  EXPECT_EQ(found->chosen[2], -1);
  for (const std::size_t v : {0, 4, 6}) views[v].clear();
  found = sharedLamp(views);
  ASSERT_TRUE(found);
  EXPECT_GT(found->miss, 3);
  EXPECT_FALSE(sharedLamp({{}, {}, {towards({0, 0, 0}, {1, 0, 0})}}));
}

}  // namespace
}  // namespace glint
