// SPDX-License-Identifier: BSD-3-Clause
#include "core/choice/pareto.h"

#include <gmock/gmock.h>

#include <limits>

namespace glint {
namespace {
using testing::ElementsAre;

TEST(Dominates, NeedsOneBetterAndNoneWorse) {
  EXPECT_TRUE(dominates({1, 10}, {2, 10}));
  EXPECT_TRUE(dominates({1, 10}, {1, 11}));
  EXPECT_FALSE(dominates({1, 10}, {1, 10}));
  EXPECT_FALSE(dominates({1, 10}, {2, 9}));
  EXPECT_FALSE(dominates({2, 9}, {1, 10}));
}

TEST(Dominates, ClearlyMeansBeyondTheSlack) {
  EXPECT_TRUE(clearlyDominates({1, 10}, {1.2, 13}, 1.1, 1.25));  // 1.1 < 1.2 and 12.5 < 13
  EXPECT_FALSE(clearlyDominates({1, 10}, {1.05, 13}, 1.1, 1.25));
  EXPECT_FALSE(clearlyDominates({1, 10}, {1.2, 12}, 1.1, 1.25));
}

TEST(ParetoFront, KeepsWhatNoOtherBeats) {
  //                      fastest, beaten,  better,  equal twin, beaten in time, most exact
  const std::vector<Cost> costs{{50, 1}, {60, 2}, {5, 10}, {5, 10}, {5, 11}, {0.1, 100}};
  EXPECT_THAT(paretoFront(costs), ElementsAre(1, 0, 1, 1, 0, 1));
}

TEST(ParetoFront, ScalesWithTheUnits) {
  const std::vector<Cost> costs{{50, 1}, {60, 2}, {5, 10}, {4, 100}};
  for (const double s : {1e-9, 1e9}) {
    std::vector<Cost> scaled;
    for (const Cost& c : costs) scaled.push_back({c.errorPct * s, c.us / s});
    EXPECT_EQ(paretoFront(scaled), paretoFront(costs));
  }
}

TEST(ParetoFront, NoNumberIsNeverOnIt) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  EXPECT_THAT(paretoFront({{nan, 1}, {1, nan}, {inf, 1}, {3, 3}}), ElementsAre(0, 0, 0, 1));
  EXPECT_THAT(paretoFront({}), testing::IsEmpty());
}

// Front: (20 %, 1), (8, 4), (1, 16), (0.5, 64), (0.4, 1024); fast is (8, 4), the fastest under 10 %. With logarithms of base 2
// from fast to exact: time 0, 2, 4, 8 over 8; error log2(8/0.4) = 4.322, 1.322, 0.322, 0 over 4.322. Distances: 1, 0.395,
// 0.505, 1.
TEST(Presets, ByHand) {
  const std::vector<Cost> costs{{0.5, 64}, {20, 1}, {30, 2}, {1, 16}, {8, 4}, {0.4, 1024}};
  const Presets p = presetsOf(costs);
  EXPECT_EQ(p.fast, 4);
  EXPECT_EQ(p.balanced, 3);
  EXPECT_EQ(p.exact, 5);
}

// The level set (0.0617 %, 5746 us) and the star (0.0619 %, 150 us) draw the same contour: the faster one is exact.
TEST(Presets, TheFastestOfTheSameErrorIsExact) {
  const Presets p = presetsOf({{0.331, 44}, {0.0619, 150}, {0.0617, 5746}});
  EXPECT_EQ(p.exact, 1);
  EXPECT_EQ(presetsOf({{0.331, 44}, {0.068, 150}, {0.0617, 5746}}).exact, 2);
}

TEST(Presets, NothingUsableTakesTheFastest) {
  const Presets p = presetsOf({{70, 5}, {90, 3}, {80, 9}});
  EXPECT_EQ(p.fast, 1);
  EXPECT_EQ(p.exact, 0);
}

TEST(Presets, OnePointIsAllOfThem) {
  const Presets p = presetsOf({{0, 5}});  // an exact scene has no error at all
  EXPECT_EQ(p.fast, 0);
  EXPECT_EQ(p.balanced, 0);
  EXPECT_EQ(p.exact, 0);
  const Presets none = presetsOf({{std::numeric_limits<double>::quiet_NaN(), 5}});
  EXPECT_EQ(none.exact, -1);
  EXPECT_EQ(none.fast, -1);
}

}  // namespace
}  // namespace glint
