// SPDX-License-Identifier: BSD-3-Clause
// What changed between two runs, on runs of which one knows it.
#include "core/report/compare_runs.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/base/number_text.h"
#include "tests/core/pipeline/exact_scene.h"

namespace glint {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// Runs made by hand: per frame one matched row with an error, or a failure.
Inspection byHand(const std::vector<std::string>& ids, const std::vector<double>& errors, int training) {
  Inspection run;
  auto scene = std::make_shared<Scene>();
  scene->name = "hand";
  scene->folder = "/data/hand";
  for (const std::string& id : ids) {
    Frame f;
    f.id = id;
    scene->frames.push_back(f);
  }
  run.scene = run.given = scene;
  run.request.models = {"dual"};
  run.request.train = "first:" + std::to_string(training);
  run.train.text = run.request.train;
  for (int i = 0; i < training; ++i) run.train.frames.push_back(i);
  ModelResult& model = run.models["dual"];
  model.model = "dual";
  for (int i = 0; i < static_cast<int>(ids.size()); ++i) {
    FrameComparison c;
    c.frame = i;
    c.light = "lamp";
    if (errors[static_cast<std::size_t>(i)] >= 0) {
      ContourMetrics m{};
      m.contourErrorPct = errors[static_cast<std::size_t>(i)];
      c.prediction = std::vector<PredictedHighlight>(1);
      c.rows.push_back({0, 0, m, {}, {}});
    } else {
      c.prediction = Failure{Reason::NoBrightestPoint, "gone"};
      c.rows.push_back({0, -1, {}, *c.prediction.failure(), {}});
    }
    model.frames.push_back(c);
    run.evidence.push_back({});
    run.evidence.back().frame = i;
  }
  return run;
}

Session withHashes(const std::vector<std::pair<std::string, std::string>>& files, const std::string& folder) {
  Session s;
  s.input = folder + "/scene.json";
  for (const auto& [name, hash] : files) s.files.push_back({folder + "/" + name, hash});
  return s;
}

std::vector<std::string> changed(const RunComparison& c, const std::string& group) {
  std::vector<std::string> names;
  for (const ComparedValue& v : c.values)
    if (v.differs && v.group == group) names.push_back(v.name);
  return names;
}

const ComparedValue& value(const RunComparison& c, const std::string& name) {
  const auto found = std::find_if(c.values.begin(), c.values.end(), [&](const ComparedValue& v) { return v.name == name; });
  if (found == c.values.end()) throw std::runtime_error("no value " + name);
  return *found;
}

TEST(CompareRuns, ARunEqualsItself) {
  const Inspection run = byHand({"a", "b", "c", "d"}, {1, 2, -1, 4}, 1);
  const Session session = withHashes({{"scene.json", "11"}, {"a.png", "22"}}, "/data/hand");
  const RunComparison c = compareRuns(session, run, session, run);
  EXPECT_EQ(c.differences(), 0);
  EXPECT_EQ(c.framesCommon, 4);
  ASSERT_EQ(c.summaries.size(), 1u);
  EXPECT_EQ(c.summaries[0].common, 2);
  EXPECT_THAT(comparisonText(c, false), HasSubstr("0 differences"));
  EXPECT_THAT(comparisonText(c, true), HasSubstr("detect.level"));
}

TEST(CompareRuns, ErrorsWithTheirRatioRolesAndReasons) {
  const Inspection a = byHand({"a", "b", "c", "d"}, {1, 2, -1, 4}, 1), b = byHand({"b", "c", "d", "e"}, {3, 5, 2, 7}, 2);
  const RunComparison c = compareRuns({}, a, {}, b);
  EXPECT_EQ(c.framesA, 4);
  EXPECT_EQ(c.framesB, 4);
  EXPECT_EQ(c.framesCommon, 3);
  ASSERT_EQ(c.errors.size(), 5u);
  EXPECT_EQ(c.errors[0].id, "a");
  EXPECT_EQ(c.errors[0].frameB, -1);
  EXPECT_EQ(c.errors[0].reasonB, "no such frame");
  EXPECT_EQ(c.errors[1].frameA, 1);
  EXPECT_EQ(c.errors[1].frameB, 0);
  EXPECT_DOUBLE_EQ(*c.errors[1].ratio, 1.5);
  EXPECT_EQ(c.errors[1].roleA, "held out");
  EXPECT_EQ(c.errors[1].roleB, "training");
  EXPECT_FALSE(c.errors[2].errorA);
  EXPECT_THAT(c.errors[2].reasonA, HasSubstr("gone"));
  EXPECT_DOUBLE_EQ(*c.errors[3].ratio, 0.5);
  EXPECT_EQ(c.errors[4].id, "e");
  // Held out in both, answered by both: d alone.
  EXPECT_EQ(c.summaries.at(0).common, 1);
  EXPECT_DOUBLE_EQ(c.summaries[0].meanA, 4);
  EXPECT_DOUBLE_EQ(c.summaries[0].meanB, 2);
  EXPECT_EQ(c.summaries[0].betterA, 0);
  EXPECT_EQ(c.summaries[0].betterB, 1);
}

/// The mean of the highlights that were found would make that frame look good.
TEST(CompareRuns, AFrameWithAMissedHighlightHasNoError) {
  Inspection a = byHand({"a", "b"}, {1, 2}, 1), b = byHand({"a", "b"}, {1, 0.1}, 1);
  b.models.at("dual").frames[1].rows.push_back({1, -1, {}, Failure{Reason::NotReached, "nothing overlaps it"}, {}});
  const RunComparison c = compareRuns({}, a, {}, b);
  ASSERT_EQ(c.errors.size(), 2u);
  EXPECT_DOUBLE_EQ(c.errors[1].errorA.value(), 2);
  EXPECT_FALSE(c.errors[1].errorB);
  EXPECT_EQ(c.errors[1].reasonB, "missed 1 of 2 highlights");
  EXPECT_FALSE(c.errors[1].ratio);
  EXPECT_EQ(c.summaries.at(0).common, 0);
}

TEST(CompareRuns, NamesWhatChanged) {
  const Inspection a = byHand({"a", "b", "c"}, {1, 2, 3}, 1);
  Inspection b = byHand({"a", "b", "c"}, {1, 2, 3}, 2);
  b.request.settings.set("detect.level", 0.4);
  b.request.excluded = {2};
  b.request.whatIf.poses[1].translation = {0, 0, 0.1};
  const Session sa = withHashes({{"scene.json", "11"}, {"a.png", "22"}, {"b.png", "33"}}, "/data/hand");
  const Session sb = withHashes({{"scene.json", "11"}, {"a.png", "99"}, {"c.png", "44"}}, "/data/hand");
  const RunComparison c = compareRuns(sa, a, sb, b);
  EXPECT_THAT(changed(c, "input"), ElementsAre("a.png", "b.png", "c.png"));
  EXPECT_THAT(changed(c, "request"), ElementsAre("training", "training frames", "excluded frames"));
  EXPECT_EQ(value(c, "training frames").b, "a, b");
  EXPECT_EQ(value(c, "excluded frames").b, "c");
  EXPECT_THAT(changed(c, "settings"), ElementsAre("detect.level"));
  EXPECT_EQ(value(c, "detect.level").a, "0.5");
  EXPECT_EQ(value(c, "detect.level").b, "0.4");
  EXPECT_THAT(changed(c, "what-if"), ElementsAre("camera of b"));
  EXPECT_EQ(value(c, "camera of b").a, "");
  EXPECT_THAT(value(c, "camera of b").b, HasSubstr("0 0 0.1 m"));
}

TEST(CompareRuns, ResultsOfTheRealPipeline) {
  const auto scene = testing_support::exactScene(testing_support::sphere(1.0), 8);
  InspectionRequest few, more;
  few.models = {"canonical"};
  few.train = "first:4";
  more.models = {"canonical", "dual"};
  more.train = "first:6";
  const Inspection a = inspect(scene, few), b = inspect(scene, more);
  const RunComparison c = compareRuns({}, a, {}, b);
  EXPECT_EQ(value(c, "canonical.frames").a, "4");
  EXPECT_EQ(value(c, "canonical.frames").b, "2");
  EXPECT_DOUBLE_EQ(*value(c, "canonical.frames").ratio, 0.5);
  EXPECT_NEAR(numberFrom(value(c, "light lamp position z").a).value_or(0), 1.4, 0.02);  // where it is
  EXPECT_EQ(value(c, "light lamp position z").unit, "m");
  for (const ComparedValue& v : c.values) EXPECT_NE(v.name.rfind("dual.", 0), 0u);  // one run alone has it
  EXPECT_TRUE(value(c, "models").differs);
  ASSERT_EQ(c.summaries.size(), 1u);  // dual is in B alone
  EXPECT_EQ(c.summaries[0].common, 2);

  const nlohmann::json j = nlohmann::json::parse(comparisonJson(c, "a.glint", "b.glint"));
  EXPECT_EQ(j["glint_comparison"], 1);
  EXPECT_EQ(j["errors"].size(), 8u);
  EXPECT_EQ(j["models"]["canonical"]["common"], 2);
}

}  // namespace
}  // namespace glint
