// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/settings.h"

#include <gtest/gtest.h>

#include <atomic>
#include <set>
#include <stdexcept>

#include "core/base/outcome.h"
#include "core/base/progress.h"

namespace glint {
namespace {

TEST(Settings, EveryDescriptionIsUsable) {
  const std::set<std::string> stages{"detect", "surface", "light", "fit", "predict", "evaluate"};
  std::set<std::string> keys;
  for (const ParamSpec& p : allParams()) {
    EXPECT_TRUE(keys.insert(p.key).second) << p.key << " twice";
    EXPECT_FALSE(p.title.empty()) << p.key;
    EXPECT_FALSE(p.symbol.empty()) << p.key;
    EXPECT_NE((p.symbol + p.help).find_first_of("=<"), std::string::npos) << p.key << " has no equation";
    EXPECT_TRUE(stages.count(p.stage)) << p.key;
    // What the user says about the input serves the bands of predictions; every other name says the stage that uses the setting.
    EXPECT_TRUE(p.key.rfind(p.stage + ".", 0) == 0 || (p.key.rfind("input.", 0) == 0 && p.stage == "predict")) << p.key;
    Settings s;
    EXPECT_NO_THROW(s.set(p.key, p.defaultValue)) << p.key << ": the default must lie in its own range";
    EXPECT_TRUE(s.values().empty()) << "a default is not stored";
  }
}

TEST(Settings, TextIsParsedAndChecked) {
  Settings s;
  s.setFromText("predict.directions", "72");
  EXPECT_EQ(s.integer("predict.directions"), 72);
  s.setFromText("detect.level", "0.2");
  EXPECT_DOUBLE_EQ(s.number("detect.level"), 0.2);
  s.setFromText("fit.solver", "linear");
  EXPECT_EQ(s.text("fit.solver"), "linear");
  s.reset("fit.solver");
  EXPECT_EQ(s.text("fit.solver"), "refined");
}

struct Bad {
  const char* key;
  const char* text;
  const char* expected;  ///< part of the message
};
class BadSetting : public testing::TestWithParam<Bad> {};

TEST_P(BadSetting, IsRefusedInOneLine) {
  Settings s;
  try {
    s.setFromText(GetParam().key, GetParam().text);
    FAIL() << GetParam().key << "=" << GetParam().text;
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find(GetParam().expected), std::string::npos) << e.what();
    EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos);
  }
  EXPECT_TRUE(s.values().empty()) << "nothing is half set";
}
INSTANTIATE_TEST_SUITE_P(Rows, BadSetting,
                         testing::Values(Bad{"predict.directionz", "3", "unknown setting"},
                                         Bad{"predict.directions", "3.5", "whole number"},
                                         Bad{"predict.directions", "5", "outside 6 .. 720"}, Bad{"detect.level", "nan", "number"},
                                         Bad{"detect.level", "0.5x", "number"}, Bad{"detect.level", "1e400", "number"},
                                         Bad{"fit.solver", "magic", "linear, anchored, refined"},
                                         Bad{"detect.level", "", "number"}));

TEST(ParallelFor, VisitsEachIndexOnceAndCanBeStopped) {
  std::vector<std::atomic<int>> visits(1000);
  parallelFor(
      1000, [&](int i) { ++visits[i]; }, {}, "test");
  for (const auto& v : visits) EXPECT_EQ(v, 1);
  std::atomic<int> done{0};
  EXPECT_THROW(parallelFor(
                   1000, [&](int) { ++done; }, [&](const StageEvent& e) { return e.done < 10; }, "test"),
               Stopped);
  EXPECT_LT(done, 100);
  EXPECT_THROW(parallelFor(
                   10,
                   [](int i) {
                     if (i == 3) throw std::runtime_error("three");
                   },
                   {}, "test"),
               std::runtime_error);
}

TEST(Outcome, HoldsAValueOrAReason) {
  const Outcome<int> value = 3, failure = Failure{Reason::TooFewViews, "need 3, have 2"};
  EXPECT_TRUE(value);
  EXPECT_EQ(*value, 3);
  ASSERT_FALSE(failure);
  EXPECT_EQ(failure.failure().message(), "too few views: need 3, have 2");
  EXPECT_THROW((void)*failure, std::bad_variant_access);
  EXPECT_EQ(std::string(InputError("a.json", "frames[3]", "id is missing").what()), "a.json: frames[3]: id is missing");
}

}  // namespace
}  // namespace glint
