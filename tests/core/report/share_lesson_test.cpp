// SPDX-License-Identifier: BSD-3-Clause
// The lesson of a shared page against the files that the inspector shows: its words, and the equations that it needs, no others.
#include <gmock/gmock.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

#include "core/report/share_parts.h"
#include "tests/core/scene/scene_fixture.h"

namespace glint::share_lesson_tests {
namespace {

using testing_support::contentOf;

using Json = nlohmann::json;
using testing::HasSubstr;

const std::filesystem::path kExplain = GLINT_SOURCE_DIR "/resources/explain";

Json fileOf(const char* name) { return Json::parse(contentOf(kExplain / name)); }

/// The committed picture of an equation, by its plain form.
std::string pictureOf(const std::string& plain) {
  const Json known = fileOf("equations.json");
  for (const Json& equation : known["equations"])
    if (equation["plain"] == plain) return contentOf(kExplain / "equations" / (equation["id"].get<std::string>() + ".svg"));
  return {};
}

std::set<std::string> plainFormsIn(const Json& lesson) {
  std::set<std::string> all;
  for (const Json& equation : lesson["equations"]) EXPECT_TRUE(all.insert(equation["plain"]).second) << equation["plain"];
  return all;
}

TEST(ShareLesson, EveryStepOfEveryLessonHasItsEquationAsThePictureOnRecord) {
  const Json lessons = fileOf("lessons.json");
  for (const Json& lesson : lessons["lessons"]) {
    const Json shared = Json::parse(share::lessonJson(lesson["id"].get<std::string>()));
    ASSERT_EQ(shared["steps"].size(), lesson["steps"].size()) << lesson["id"];
    const std::set<std::string> there = plainFormsIn(shared);
    const std::string words = lesson.dump(-1, ' ', false);
    std::set<std::string> shown;
    for (const Json& step : shared["steps"])
      if (step["equation"] != "") shown.insert(step["equation"].get<std::string>());
    for (const std::string& plain : shown) EXPECT_EQ(there.count(plain), 1U) << lesson["id"] << ": " << plain;
    for (const Json& equation : shared["equations"]) {
      const std::string plain = equation["plain"], svg = equation["svg"];
      EXPECT_TRUE(shown.count(plain) > 0 || words.find(plain) != std::string::npos) << lesson["id"] << " does not need " << plain;
      EXPECT_EQ(svg + "\n", pictureOf(plain)) << plain;
    }
  }
}

TEST(ShareLesson, EquationsWithinTextsAreTypesetToo) {
  const Json lesson = Json::parse(share::lessonJson("bent-mirror"));
  const std::set<std::string> there = plainFormsIn(lesson);
  // Three steps, the mirror equation of what there is to see, half of the width in a question.
  EXPECT_EQ(there.size(), 5U);
  EXPECT_EQ(there.count("1/d′ = 1/d + 2 κ cos θ"), 1U);
  EXPECT_EQ(there.count("w = α_lim / (κ + (1/d + 1/r) / (2 cos θ))"), 1U);
  EXPECT_EQ(lesson["symbols"]["curvature"], "curvature of the mirror");
  EXPECT_FALSE(lesson["symbols"].contains("ellipsoid")) << "no equation of this lesson has it";
}

TEST(ShareLesson, QuestionsHaveTheirAnswers) {
  const Json lesson = Json::parse(share::lessonJson("mirror"));
  ASSERT_EQ(lesson["questions"].size(), 3U);
  EXPECT_THAT(lesson["questions"][1]["ask"].get<std::string>(), HasSubstr("Which quantity is the same in all frames?"));
  EXPECT_THAT(lesson["questions"][1]["answer"].get<std::string>(), HasSubstr("The mirror image of the lamp"));
}

TEST(ShareLesson, APlainLessonHasItsOwnWordsAndNoEquation) {
  const Json lesson = Json::parse(share::lessonJson("moving-highlight"));
  EXPECT_TRUE(lesson["equations"].empty());
  EXPECT_EQ(lesson["steps"][1]["title"], "A small mirror");
  EXPECT_THAT(lesson["steps"][1]["text"].get<std::string>(), HasSubstr("the sheet acts as a small mirror"));
  for (const Json& step : lesson["steps"]) {
    EXPECT_EQ(step["equation"], "");
    EXPECT_EQ(step["remark"], "") << "said twice";
  }
}

TEST(ShareLesson, WhatIsNoLessonHasNone) {
  EXPECT_EQ(share::lessonJson(""), "null");
  EXPECT_EQ(share::lessonJson("no such lesson"), "null");
}

}  // namespace
}  // namespace glint::share_lesson_tests
