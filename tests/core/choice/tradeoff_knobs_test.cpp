// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <algorithm>
#include <set>

#include "core/choice/tradeoff.h"

namespace glint {
namespace {
using testing::ElementsAre;

std::vector<std::string> texts(const Knob& k) {
  std::vector<std::string> all;
  for (const SettingValue& v : k.values) all.push_back(textOf(v));
  return all;
}

const Knob* find(const std::vector<Knob>& knobs, const std::string& key) {
  const auto it = std::find_if(knobs.begin(), knobs.end(), [&](const Knob& k) { return k.key == key; });
  return it == knobs.end() ? nullptr : &*it;
}

// method.md section 12 names them.
TEST(Knobs, AreTheOnesOfTheMethod) {
  const std::vector<Knob> knobs = knobsOf(Settings());
  for (const char* key : {"surface.normals", "surface.rays", "light.solver", "fit.solver", "predict.directions",
                          "predict.level_set_step", "predict.walk_tolerance"})
    EXPECT_NE(find(knobs, key), nullptr) << key;
  for (const Knob& k : knobs) EXPECT_NE(paramSpec(k.key).stage, "detect") << k.key;
  EXPECT_EQ(find(knobs, "predict.band"), nullptr) << "it changes no contour and is not timed";
  Settings loose;  // where it differs from its default as well
  loose.set("fit.most_residual", 0.3);
  for (const Settings& s : {Settings(), loose})
    EXPECT_EQ(find(knobsOf(s), "fit.most_residual"), nullptr) << "it decides what is an answer";
  EXPECT_THAT(texts(*find(knobs, "fit.solver")), ElementsAre("linear", "anchored", "refined"));
  EXPECT_THAT(texts(*find(knobs, "predict.directions")), ElementsAre("12", "18", "24", "36", "72"));
}

TEST(Knobs, KeepTheValueThatTheUserChose) {
  Settings settings;
  settings.setFromText("predict.directions", "50");
  EXPECT_THAT(texts(*find(knobsOf(settings), "predict.directions")), ElementsAre("12", "18", "24", "36", "50", "72"));
}

// A setting that nobody has thought of here: every kind of knob, and what does not count as one.
TEST(Knobs, FindSettingsThatAreAddedLater) {
  std::vector<ParamSpec> params(6);
  params[0] = {"predict.query", "", "", "", std::string("exact"), 0, 0, 0, {"exact", "local-quadric"}, "", "predict"};
  params[1] = {"predict.fast", "", "", "", false, 0, 0, 0, {}, "", "predict"};
  params[2] = {"predict.samples", "", "", "", 10, 8, 100, 1, {}, "", "predict"};  // half of it is out of range
  params[3] = {"fit.weight", "", "", "", 1.0, 0, 10, 1, {}, "", "fit"};           // not of prediction: unknown what it means
  params[4] = {"detect.method", "", "", "", std::string("a"), 0, 0, 0, {"a", "b"}, "", "detect"};
  params[5] = {"predict.only", "", "", "", std::string("a"), 0, 0, 0, {"a"}, "", "predict"};
  const std::vector<Knob> knobs = knobsOf(Settings(), params);
  ASSERT_EQ(knobs.size(), 3u);
  EXPECT_THAT(texts(knobs[0]), ElementsAre("exact", "local-quadric"));
  EXPECT_THAT(texts(knobs[1]), ElementsAre("false", "true"));
  EXPECT_THAT(texts(knobs[2]), ElementsAre("10", "20"));
}

TEST(Knobs, ShortNamesAreUnique) {
  std::set<std::string> names{"model"};
  for (const Knob& k : knobsOf(Settings())) EXPECT_TRUE(names.insert(knobName(k.key)).second) << k.key;
  EXPECT_EQ(knobName("predict.directions"), "directions");
  EXPECT_EQ(knobName("fit.solver"), "solver");
  EXPECT_EQ(knobName("light.solver"), "light_solver");
}

}  // namespace
}  // namespace glint
