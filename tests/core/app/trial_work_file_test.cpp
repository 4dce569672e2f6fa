// SPDX-License-Identifier: BSD-3-Clause
#include "core/app/trial_work_file.h"

#include <gtest/gtest.h>

#include "tests/core/choice/points.h"
#include "tests/core/scene/scene_fixture.h"

namespace glint {
namespace {
using namespace testing_support;

TEST(WorkFile, KeepsResultsAndFailuresOfItsKey) {
  const TemporaryFolder folder;
  {
    WorkFile work(folder / "w", "key");
    work.add("a", Outcome<TrialResult>(TrialResult{0.1, 12.5, "abc"}));
    work.add("b", Outcome<TrialResult>(Failure{Reason::NotAnEllipsoid, "why"}));
    work.add("a", Outcome<TradeoffPoint>(point("dual", 3, 4)));
  }
  const WorkFile again(folder / "w", "key");
  EXPECT_EQ(again.size(), 3);
  ASSERT_TRUE(again.coarse("a"));
  EXPECT_EQ((**again.coarse("a")).errorPct, 0.1);  // exactly: the search must decide the same
  EXPECT_EQ((**again.coarse("a")).us, 12.5);
  EXPECT_EQ((**again.coarse("a")).predictions, "abc");
  EXPECT_EQ(again.coarse("b")->failure().reason, Reason::NotAnEllipsoid);
  EXPECT_EQ(again.coarse("b")->failure().detail, "why");
  EXPECT_FALSE(again.coarse("c"));
  ASSERT_TRUE(again.full("a"));
  EXPECT_EQ((**again.full("a")).predictUs, 4);
  EXPECT_EQ((**again.full("a")).rankedErrorPct, 3);
}

TEST(WorkFile, IsEmptyForAnotherKeyOrWhenItIsBroken) {
  const TemporaryFolder folder;
  {
    WorkFile work(folder / "w", "key");
    work.add("a", Outcome<TrialResult>(TrialResult{0.1, 12.5, "abc"}));
  }
  EXPECT_EQ(WorkFile(folder / "w", "other").size(), 0);
  const std::string text = contentOf(folder / "w");
  for (const std::string& broken : {text.substr(0, text.size() / 2), std::string("[]"), std::string(), std::string("\0\1", 2)}) {
    folder.write("w", broken);
    EXPECT_EQ(WorkFile(folder / "w", "key").size(), 0);
  }
  // Numbers that no int holds, and a reason that does not exist, are not taken for something else.
  const std::string start = R"({"glint_tradeoff_work":2,"key":"key","coarse":{"a":)";
  for (const std::string result :
       {R"({"reason":3,"detail":""})", R"({"reason":"","detail":""})", R"({"reason":"too few view","detail":""})",
        R"({"reason":null,"detail":""})", R"({"error_pct":"1","us":1,"predictions":""})"}) {
    folder.write("w", start + result + R"(},"full":{}})");
    EXPECT_EQ(WorkFile(folder / "w", "key").size(), 0) << result;
  }
  folder.write("w", start + R"({"reason":"too few views","detail":""}},"full":{}})");
  EXPECT_EQ(WorkFile(folder / "w", "key").size(), 1) << "the same file with nothing wrong";
  EXPECT_EQ(WorkFile(folder.path(), "key").size(), 0) << "a folder";
  EXPECT_EQ(WorkFile("", "key").size(), 0);
}

}  // namespace
}  // namespace glint
