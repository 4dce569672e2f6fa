// SPDX-License-Identifier: BSD-3-Clause
// Delta debugging on properties whose smallest parts are known.
#include "core/base/minimal_subset.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "core/base/progress.h"

namespace glint {
namespace {

using testing::ElementsAre;

std::vector<int> upTo(int n) {
  std::vector<int> all(static_cast<std::size_t>(n));
  std::iota(all.begin(), all.end(), 0);
  return all;
}

bool has(const std::vector<int>& part, int item) { return std::find(part.begin(), part.end(), item) != part.end(); }

TEST(MinimalSubset, FindsTheCauseOfAMonotoneFault) {
  for (const int n : {3, 8, 100, 1410}) {
    const int x = n / 3, y = n - 1;
    int asked = 0;
    const std::vector<int> found = minimalSubset(upTo(n), [&](const std::vector<int>& part) {
      ++asked;
      return has(part, x) && has(part, y);
    });
    EXPECT_THAT(found, ElementsAre(x, y)) << n;
    EXPECT_LE(asked, 4 * std::log2(n) * 2 + 12) << n;
  }
}

TEST(MinimalSubset, KeepsEnoughItemsOfAnyKind) {
  // Three are needed, whichever: no single one of what remains may be missing.
  EXPECT_EQ(minimalSubset(upTo(20), [](const std::vector<int>& part) { return part.size() >= 3; }).size(), 3u);
}

TEST(MinimalSubset, IsOneMinimalWhereTheFaultIsNotMonotone) {
  // The sum is divisible by 7: parts of parts show it, and others do not.
  const auto shows = [](const std::vector<int>& part) {
    return !part.empty() && std::accumulate(part.begin(), part.end(), 0) % 7 == 0;
  };
  std::vector<int> all = {3, 5, 6, 9, 10, 12, 4};  // 49
  ASSERT_TRUE(shows(all));
  const std::vector<int> found = minimalSubset(all, shows);
  EXPECT_TRUE(shows(found));
  for (std::size_t i = 0; i < found.size(); ++i) {
    std::vector<int> less = found;
    less.erase(less.begin() + static_cast<std::ptrdiff_t>(i));
    EXPECT_FALSE(shows(less));
  }
}

TEST(MinimalSubset, EverythingMayBeNeeded) {
  int asked = 0;
  const auto whole = [&](const std::vector<int>& part) {
    ++asked;
    return part.size() == 6;
  };
  EXPECT_EQ(minimalSubset(upTo(6), whole), upTo(6));
  EXPECT_LE(asked, 6 * 6 + 3 * 6);
  EXPECT_THAT(minimalSubset({4}, whole), ElementsAre(4));
  EXPECT_TRUE(minimalSubset({}, whole).empty());
}

TEST(MinimalSubset, AsksNoQuestionTwiceAndStops) {
  std::set<std::vector<int>> questions;
  minimalSubset(upTo(30), [&](const std::vector<int>& part) {
    EXPECT_TRUE(questions.insert(part).second);
    return has(part, 3) && has(part, 17) && has(part, 18);
  });
  EXPECT_THROW(minimalSubset(
                   upTo(30), [](const std::vector<int>&) { return false; }, [](int asked, int) { return asked < 4; }),
               Stopped);
}

}  // namespace
}  // namespace glint
