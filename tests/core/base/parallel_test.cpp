// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <atomic>
#include <numeric>
#include <stdexcept>
#include <vector>

#include "core/base/progress.h"

namespace glint {
namespace {

TEST(Parallel, EveryIndexOnceWhateverTheNumber) {
  for (const int n : {0, 1, 2, 7, 1000}) {
    std::vector<int> times(static_cast<std::size_t>(n), 0);
    parallelFor(
        n, [&](int i) { ++times[static_cast<std::size_t>(i)]; }, {}, "count");
    EXPECT_EQ(times, std::vector<int>(static_cast<std::size_t>(n), 1));
  }
}

TEST(Parallel, ProgressIsReportedOneAtATimeAndEndsComplete) {
  int inside = 0, last = -1, reports = 0;  // not atomic: the function says that reports do not overlap
  parallelFor(
      200, [](int) {},
      [&](const StageEvent& e) {
        EXPECT_EQ(++inside, 1);
        EXPECT_EQ(e.done, last + 1);
        EXPECT_EQ(e.total, 200);
        last = e.done;
        ++reports;
        --inside;
        return true;
      },
      "count");
  EXPECT_EQ(last, 200);
  EXPECT_EQ(reports, 201);
}

TEST(Parallel, StopEndsItBeforeTheEnd) {
  std::atomic<int> done{0};
  EXPECT_THROW(parallelFor(
                   100000, [&](int) { ++done; }, [](const StageEvent& e) { return e.done < 5; }, "count"),
               Stopped);
  EXPECT_GE(done, 5);
  EXPECT_LT(done, 100000);
  EXPECT_THROW(parallelFor(
                   3, [&](int) { FAIL(); }, [](const StageEvent&) { return false; }, "count"),
               Stopped);
}

TEST(Parallel, AnExceptionOfTheWorkOrOfTheReportReachesTheCaller) {
  EXPECT_THROW(parallelFor(
                   100,
                   [](int i) {
                     if (i == 50) throw std::runtime_error("50");
                   },
                   {}, "count"),
               std::runtime_error);
  EXPECT_THROW(
      parallelFor(
          100, [](int) {}, [](const StageEvent& e) { return e.done < 10 ? true : throw std::logic_error("report"); }, "count"),
      std::logic_error);
}

}  // namespace
}  // namespace glint
