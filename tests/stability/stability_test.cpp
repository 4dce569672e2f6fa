// SPDX-License-Identifier: BSD-3-Clause
#include "tests/stability/stability.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>
#include <set>

namespace glint {
namespace {

/// All cases, run once.
const std::vector<StabilityResult>& results() {
  static const std::vector<StabilityResult> all = runStability();
  return all;
}

TEST(Stability, NoCaseIsWrong) {
  for (const StabilityResult& r : results()) {
    EXPECT_NE(r.verdict, CaseVerdict::Wrong) << r.stage << ": " << r.name << ": " << r.reason << ", error " << r.relativeError;
    EXPECT_EQ(r.verdict == CaseVerdict::Accurate, r.reason.empty()) << r.stage << ": " << r.name;
    if (r.verdict == CaseVerdict::Accurate) {
      EXPECT_LE(r.relativeError, r.tolerance) << r.name;
    }
    // A wider tolerance and a failure both need their reason in the table.
    if (r.tolerance > 1e-9 || r.verdict == CaseVerdict::NamedFailure) {
      EXPECT_FALSE(r.note.empty()) << r.stage << ": " << r.name;
    }
    EXPECT_TRUE(std::isfinite(r.parameter) && std::isfinite(r.condition) && std::isfinite(r.relativeError)) << r.name;
  }
}

TEST(Stability, EveryExtremeThatMustBeAccurateIs) {
  // What issue and method name as never allowed to fail, by words of the cases' names: each in several stages.
  const std::vector<std::pair<std::string, int>> needed{
      {"light at 1e9 m", 5},     {"light at infinity", 5},    {"scene scale 1e-6", 8},      {"scene scale 1e6", 8},
      {"curvature 1e-9", 5},     {"1,000 views", 5},          {"one zero axis", 4},         {"times", 4},
      {"grazing 85 degrees", 8}, {"grazing 89.9 degrees", 7}, {"grazing 89.99 degrees", 5}, {"UTM", 18},
      {"at 1e7 m", 18},          {"levels 0.02 to 0.98", 23}, {"levels 0.1 to 0.98", 1},    {"focal length 1e6 px", 6},
      {"skew 1,000 px", 6}};
  for (const auto& [words, count] : needed) {
    int accurate = 0;
    for (const StabilityResult& r : results())
      if (r.name.find(words) != std::string::npos) {
        EXPECT_EQ(r.verdict, CaseVerdict::Accurate) << r.stage << ": " << r.name;
        ++accurate;
      }
    EXPECT_GE(accurate, count) << words;
  }
  EXPECT_GE(results().size(), 60u);
  std::set<std::pair<std::string, std::string>> names;
  for (const StabilityResult& r : results()) names.insert({r.stage, r.name});
  EXPECT_EQ(names.size(), results().size()) << "two cases of one stage share a name";
}

TEST(Stability, JsonKeepsTheContract) {
  const nlohmann::json j = nlohmann::json::parse(stabilityJson(results()));
  EXPECT_EQ(j.at("glint_stability"), 1);
  ASSERT_EQ(j.at("cases").size(), results().size());
  for (const auto& c : j.at("cases")) {
    EXPECT_EQ(c.size(), 8u);
    for (const char* key : {"case", "stage", "verdict", "reason"}) EXPECT_TRUE(c.at(key).is_string()) << c;
    for (const char* key : {"parameter", "condition", "relative_error", "tolerance"}) EXPECT_TRUE(c.at(key).is_number()) << c;
    EXPECT_THAT(c.at("verdict").get<std::string>(), testing::AnyOf("accurate", "named failure", "wrong"));
  }
}

TEST(Stability, ReportsShowWhatIsWrong) {
  StabilityResult bad;
  bad.name = "a case";
  bad.stage = "a stage";
  bad.relativeError = 0.5;
  bad.tolerance = 1e-9;
  bad.reason = "beyond the tolerance";
  const std::string table = stabilityTable({bad});
  EXPECT_THAT(table, testing::HasSubstr("wrong: beyond the tolerance"));
  EXPECT_THAT(table, testing::HasSubstr("1 cases: 0 accurate, 0 named failures, 1 wrong"));
  EXPECT_THAT(stabilityMarkdown({bad}),
              testing::HasSubstr("| a stage | a case | 1 | 5.0e-01 | 1.0e-09 | wrong: beyond the tolerance |"));
}

TEST(Stability, StopsWhenAsked) {
  int calls = 0;
  EXPECT_THROW((void)runStability([&](const StageEvent&) { return ++calls < 3; }), Stopped);
  EXPECT_EQ(calls, 3);
}

}  // namespace
}  // namespace glint
