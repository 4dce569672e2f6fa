// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/stage_times.h"

#include <gtest/gtest.h>

namespace glint::stage_times_tests {

TEST(StageTimes, AStageLastsUntilTheNextOneReports) {
  double now = 100;
  StageTimes times([&] { return now; });
  EXPECT_EQ(times.stage(), "");
  times.note({"detect", 0, 24});
  now += 0.25;
  times.note({"detect", 24, 24});
  now += 0.25;
  times.note({"light", 0, 1});
  EXPECT_EQ(times.stage(), "light");
  now += 0.125;
  EXPECT_EQ(times.text(), "detect 24 in 0.500 s, light in 0.125 s; 0.625 s in all");
}

TEST(StageTimes, AStageThatComesAgainIsCountedOnce) {
  double now = 0;
  StageTimes times([&] { return now; });
  for (const char* stage : {"fit", "predict", "fit", "predict"}) {
    times.note({stage, 0, 3});
    now += 1;
  }
  EXPECT_EQ(times.text(), "fit 3 in 2.000 s, predict 3 in 2.000 s; 4.000 s in all");
}

TEST(StageTimes, AStageOfNoTimeIsNamedAlone) {
  double now = 0;
  StageTimes times([&] { return now; });
  times.note({"surface", 0, 0});
  now += 0.0004;
  times.note({"light", 0, 0});
  now += 2;
  EXPECT_EQ(times.text(), "surface, light in 2.000 s; 2.000 s in all");
}

TEST(StageTimes, NothingReportedIsNothing) {
  StageTimes times([] { return 7.0; });
  EXPECT_EQ(times.text(), "0.000 s in all");
}

}  // namespace glint::stage_times_tests
