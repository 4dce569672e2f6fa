// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/solver_trace.h"

#include <gtest/gtest.h>

#include <limits>
#include <thread>

namespace glint::solver_trace_tests {

void oneRun(bool converged) {
  TracedRun run("light", Eigen::Vector4d(0, 0, 2, 2));
  traceRound({5, 3, 1});
  traceRound({7});
  run.end(converged, converged ? "converged" : "out of iterations", Eigen::Vector4d(3, 0, 4, 0));
  if (converged) traceAnswer(run.index());
}

TEST(SolverTrace, KeepsRunsInOrderWithTheirRounds) {
  SolverTrace trace;
  oneRun(false);
  oneRun(true);
  ASSERT_EQ(trace.runs().size(), 2U);
  const SolverRun& first = trace.runs()[0];
  EXPECT_EQ(first.rounds, (std::vector<std::vector<double>>{{5, 3, 1}, {7}}));
  EXPECT_EQ(first.steps(), 2);
  EXPECT_FALSE(first.answer);
  EXPECT_TRUE(trace.runs()[1].answer);
  ASSERT_TRUE(first.start && first.end);
  EXPECT_NEAR((*first.start - Eigen::Vector4d(0, 0, 1, 1) / std::sqrt(2.0)).norm(), 0, 1e-15);
  EXPECT_NEAR((*first.end - Eigen::Vector4d(0.6, 0, 0.8, 0)).norm(), 0, 1e-15);
}

TEST(SolverTrace, ALaterAnswerTakesTheEarlierOnesPlace) {
  SolverTrace trace;
  oneRun(true);
  oneRun(true);
  EXPECT_FALSE(trace.runs()[0].answer);
  EXPECT_TRUE(trace.runs()[1].answer);
}

TEST(SolverTrace, RunsWithinRunsKeepTheirOwnRounds) {
  SolverTrace trace;
  {
    TracedRun outer("outer");
    traceRound({1});
    oneRun(true);
    traceRound({2});
  }
  ASSERT_EQ(trace.runs().size(), 2U);
  EXPECT_EQ(trace.runs()[0].rounds, (std::vector<std::vector<double>>{{1}, {2}}));
  EXPECT_EQ(trace.runs()[0].ending, "no usable step") << "nothing said how it ended";
  EXPECT_EQ(trace.runs()[1].rounds.size(), 2U);
}

TEST(SolverTrace, NothingHappensWhereNobodyRecordsAndOtherThreadsAreNotSeen) {
  oneRun(true);
  EXPECT_EQ(TracedRun("nobody").index(), -1);
  SolverTrace trace;
  std::thread([] { oneRun(true); }).join();
  EXPECT_TRUE(trace.runs().empty());
  {
    SolverTrace inner;
    oneRun(true);
    EXPECT_EQ(inner.runs().size(), 1U);
  }
  EXPECT_TRUE(trace.runs().empty());
  oneRun(true);
  EXPECT_EQ(trace.runs().size(), 1U);
}

TEST(SolverTrace, APlaceThatIsNoNumberIsNone) {
  SolverTrace trace;
  {
    TracedRun run("light", Eigen::Vector4d(0, 0, std::numeric_limits<double>::quiet_NaN(), 1));
    run.end(false, "no usable step", Eigen::Vector4d::Zero());
  }
  EXPECT_FALSE(trace.runs().at(0).start);
  EXPECT_FALSE(trace.runs().at(0).end);
}

}  // namespace glint::solver_trace_tests
