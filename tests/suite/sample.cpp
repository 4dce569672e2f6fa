// SPDX-License-Identifier: BSD-3-Clause
// Cases that end in every way a case can end: what suite_test.py looks at. No CTest entry runs this program.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <iostream>

namespace {

TEST(Good, A) {}
TEST(Good, B) { std::cout << "[ RUN "; }  // part of a mark
TEST(Good, C) { std::cout << "no end of line"; }
TEST(Good, DISABLED_D) { FAIL(); }

class Numbers : public testing::TestWithParam<int> {};
TEST_P(Numbers, ArePositive) { EXPECT_GT(GetParam(), 0); }
INSTANTIATE_TEST_SUITE_P(Some, Numbers, testing::Values(1, 2, 3, 4));

TEST(Bad, Fails) {
  std::cout << "said before\n";
  EXPECT_EQ(1, 2) << "not text: \xff\x01";
}
TEST(Bad, IsSkipped) { GTEST_SKIP() << "no data beside the project"; }

TEST(Ends, ByAborting) {
  std::cout << "said before";
  std::cout.flush();
  std::abort();
}
TEST(Ends, ByExit) { std::_Exit(0); }
TEST(Ends, Never) {
  for (;;) ::pause();
}

TEST(AtTheEnd, ComesAnExitCode) {
  std::atexit([] { std::_Exit(9); });
}

class NoSuite : public testing::Test {
 protected:
  static void SetUpTestSuite() { ADD_FAILURE() << "nothing to stand on"; }
};
TEST_F(NoSuite, IsNotRun) {}

/// Passes once in a process.
int runs = 0;
TEST(Alone, First) { EXPECT_EQ(++runs, 1); }
TEST(Alone, Second) { EXPECT_EQ(++runs, 1); }

}  // namespace
