// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <limits>

#include "core/base/outcome.h"
#include "core/choice/tradeoff.h"
#include "tests/core/choice/points.h"

namespace glint {
namespace {
using namespace testing_support;
using testing::HasSubstr;

/// Sorted by time: 0 primal 20 % 1 us, 1 dual 8 % 4 us, 2 dual 9 % 5 us (beaten), 3 canonical 1 % 16 us, 4 limit-angle 0.4 % 1024
/// us.
Tradeoff five() {
  Tradeoff t;
  t.points = {point("canonical", 1, 16), point("limit-angle", 0.4, 1024), point("primal", 20, 1), point("dual", 9, 5),
              point("dual", 8, 4)};
  return t;
}

TEST(RankedError, IsTheContourErrorWhereNothingIsLeftOut) {
  TradeoffPoint p = point("dual", 3, 1);
  p.coverage = 0.99;
  EXPECT_EQ(rankedErrorPct(p), 3);
}

// A work file says what it likes: counts whose sum is no int (found by the sanitizers with the corpus of damaged work files).
TEST(RankedError, OfTheLargestCounts) {
  TradeoffPoint p = point("dual", 3, 1);
  p.matched = p.missed = p.spurious = std::numeric_limits<int>::max();
  EXPECT_DOUBLE_EQ(rankedErrorPct(p), (3 + 2 * 100) / 3.0);
}

TEST(RankedError, CountsWhatIsLeftOutAsAWholeError) {
  TradeoffPoint p = point("dual", 3, 1);
  p.matched = 8;
  p.missed = 2;
  EXPECT_DOUBLE_EQ(rankedErrorPct(p), (8 * 3 + 2 * 100) / 10.0);
  p.spurious = 10;
  EXPECT_DOUBLE_EQ(rankedErrorPct(p), (8 * 3 + 12 * 100) / 20.0);
  TradeoffPoint gaps = point("dual", 3, 1);
  gaps.coverage = 0.5;
  EXPECT_DOUBLE_EQ(rankedErrorPct(gaps), 0.5 * 3 + 0.5 * 100);
  TradeoffPoint nothing;
  nothing.missed = 4;
  EXPECT_EQ(rankedErrorPct(nothing), 100);
  EXPECT_EQ(rankedErrorPct(TradeoffPoint{}), 100);
}

TEST(ChoosePoint, SortsMarksTheFrontAndTakesTheBalancedPreset) {
  Tradeoff t = five();
  choosePoint(t, {});
  std::vector<double> times;
  std::vector<bool> front;
  for (const TradeoffPoint& p : t.points) {
    times.push_back(p.predictUs);
    front.push_back(p.pareto);
  }
  EXPECT_THAT(times, testing::ElementsAre(1, 4, 5, 16, 1024));
  EXPECT_THAT(front, testing::ElementsAre(true, true, false, true, true));
  EXPECT_EQ(t.presets, (std::map<std::string, int>{{"fast", 1}, {"balanced", 3}, {"exact", 4}}));
  EXPECT_EQ(t.chosen, 3);
  EXPECT_THAT(t.reason, HasSubstr("canonical (1 % at 16 us per frame)"));
}

TEST(ChoosePoint, BudgetTakesTheMostAccurateWithin) {
  Tradeoff t = five();
  choosePoint(t, {.budgetUs = 15.9});
  EXPECT_EQ(t.chosen, 1);
  EXPECT_THAT(t.reason, HasSubstr("The most accurate setting within 15.9 us per frame is dual (8 % at 4 us per frame)"));
  EXPECT_THAT(t.reason, HasSubstr("the next more accurate one, canonical"));
  choosePoint(t, {.budgetUs = 16});
  EXPECT_EQ(t.chosen, 3);
  choosePoint(t, {.budgetUs = 1e9});
  EXPECT_EQ(t.chosen, 4);
  choosePoint(t, {.budgetUs = 0.5});
  EXPECT_FALSE(t.chosen);
  EXPECT_THAT(t.reason, HasSubstr("within 0.5 us; the fastest is primal (20 % at 1 us per frame)"));
  EXPECT_EQ(t.presets.size(), 3u);  // they do not depend on the bound
}

TEST(ChoosePoint, LargestErrorTakesTheFastestUnder) {
  Tradeoff t = five();
  choosePoint(t, {.maxErrorPct = 8});
  EXPECT_EQ(t.chosen, 1);
  EXPECT_THAT(t.reason, HasSubstr("the next faster one, primal"));
  choosePoint(t, {.maxErrorPct = 7.9});
  EXPECT_EQ(t.chosen, 3);
  choosePoint(t, {.maxErrorPct = 99});
  EXPECT_EQ(t.chosen, 0);
  choosePoint(t, {.maxErrorPct = 0.3});
  EXPECT_FALSE(t.chosen);
  EXPECT_THAT(t.reason, HasSubstr("the most accurate is limit-angle (0.4 % at 1.02e+03 us per frame)"));
}

TEST(ChoosePoint, LeavingOutDoesNotWin) {
  Tradeoff t = five();
  TradeoffPoint lucky = point("dual", 0.01, 0.5);  // answered one of ten
  lucky.matched = lucky.predicted = 1;
  lucky.missed = 9;
  lucky.rankedErrorPct = rankedErrorPct(lucky);
  t.points.push_back(lucky);
  choosePoint(t, {.maxErrorPct = 8});
  EXPECT_EQ(t.points[*t.chosen].contourErrorPct, 8);
}

TEST(ChoosePoint, WithoutPointsSaysSo) {
  Tradeoff t;
  choosePoint(t, {});
  EXPECT_FALSE(t.chosen);
  EXPECT_TRUE(t.presets.empty());
  EXPECT_FALSE(t.reason.empty());
}

TEST(PointOfPreset, FindsNamesAndRefusesOthers) {
  Tradeoff t = five();
  choosePoint(t, {.budgetUs = 4});
  EXPECT_EQ(pointOfPreset(t, "exact").model, "limit-angle");
  EXPECT_EQ(pointOfPreset(t, "chosen").model, "dual");
  EXPECT_THROW(pointOfPreset(t, "quick"), InputError);
  choosePoint(t, {.budgetUs = 0.5});
  EXPECT_THROW(pointOfPreset(t, "chosen"), InputError);
}

}  // namespace
}  // namespace glint
