// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/base/outcome.h"
#include "core/report/tradeoff_html.h"
#include "core/tradeoff/choice.h"
#include "tests/core/tradeoff/points.h"

namespace glint {
namespace {
using namespace testing_support;
using testing::HasSubstr;

Tradeoff example() {
  Tradeoff t;
  t.input = "a <b>";
  t.train = {0, 5};
  t.trainSpec = "0,5";
  t.knobs = {"surface.normals", "light.solver", "fit.solver", "predict.directions"};
  t.points = {point("dual", 8, 4), point("canonical", std::nan(""), 16), point("canonical", 1, 16)};
  t.points[2].settings.setFromText("predict.directions", "24");
  t.points[2].settings.setFromText("fit.solver", "anchored");
  t.points[2].settings.setFromText("light.robust_px", "0.5");  // no knob: the user's own
  t.pruned = {{"primal", Settings(), "failed", "why & how", std::nan(""), std::nan("")}};
  t.trials = 12;
  t.measurement = "with care";
  choosePoint(t, {});
  return t;
}

TEST(TradeoffJson, HasTheKeysOfTheContract) {
  const auto j = nlohmann::json::parse(tradeoffJson(example()));
  EXPECT_EQ(j["glint_tradeoff"], 1);
  EXPECT_EQ(j["train"], (std::vector<int>{0, 5}));
  const auto& p = j["points"][1];
  EXPECT_EQ(p["settings"]["model"], "canonical");
  const auto& anchored = j["points"][2]["settings"];
  EXPECT_EQ(anchored["directions"], 24);
  EXPECT_EQ(anchored["normals"], "interpolated");
  EXPECT_EQ(anchored["solver"], "anchored");
  EXPECT_EQ(anchored["light_solver"], "bundle");
  for (const char* key : {"contour_error_pct", "iou", "coverage", "predict_us", "fit_us", "peak_mb", "pareto"})
    EXPECT_TRUE(p.contains(key)) << key;
  EXPECT_TRUE(p["contour_error_pct"].is_null()) << "NaN is no JSON";
  EXPECT_EQ(j["presets"].size(), 3u);
  EXPECT_TRUE(j["chosen"].is_number_integer());
  EXPECT_EQ(j["reason"].get<std::string>().empty(), false);
}

TEST(TradeoffJson, RoundTripKeepsEverything) {
  const Tradeoff t = example();
  const std::string text = tradeoffJson(t);
  const Tradeoff back = readTradeoff(JsonNode::parse(text, "x.glint"));
  EXPECT_EQ(tradeoffJson(back), text);
  EXPECT_TRUE(back.points[2].settings == t.points[2].settings);
  EXPECT_EQ(back.chosen, t.chosen);
  Tradeoff none = t;
  none.chosen.reset();
  EXPECT_FALSE(readTradeoff(JsonNode::parse(tradeoffJson(none), "")).chosen);
}

TEST(TradeoffJson, NamesThePlaceOfWhatIsWrong) {
  const auto messageOf = [](const std::string& from, const std::string& to) -> std::string {
    std::string text = tradeoffJson(example());
    const std::size_t at = text.find(from);
    if (at == std::string::npos) return "not found: " + from;
    text.replace(at, from.size(), to);
    try {
      readTradeoff(JsonNode::parse(text, "x.glint"));
    } catch (const InputError& e) {
      return e.what();
    }
    return "accepted";
  };
  EXPECT_THAT(messageOf("\"glint_tradeoff\": 1", "\"glint_tradeoff\": 2"), HasSubstr("glint_tradeoff"));
  EXPECT_THAT(messageOf("\"exact\": 2", "\"exact\": 3"), HasSubstr("presets.exact: is not an index into points"));
  EXPECT_THAT(messageOf("\"predict.directions\": 24", "\"predict.directions\": 1"),
              HasSubstr("points[2].set.predict.directions"));
  EXPECT_THAT(messageOf("\"surface.normals\"", "\"surface.abnormals\""), HasSubstr("knobs[0]: unknown setting"));
}

TEST(TradeoffHtml, IsSelfContainedAndEscaped) {
  const std::string html = tradeoffHtml(example());
  EXPECT_THAT(html, HasSubstr("a &lt;b&gt;"));
  EXPECT_THAT(html, HasSubstr("why &amp; how"));
  EXPECT_THAT(html, HasSubstr("<svg"));
  EXPECT_THAT(html, testing::ContainsRegex(">[a-z, ()]*chosen[)]?</text>"))
      << "the plot names the chosen setting, a preset or not";
  EXPECT_THAT(html, HasSubstr("prefers-color-scheme:dark"));
  EXPECT_THAT(html, HasSubstr("canonical, solver anchored, directions 24"));
  for (const char* outside : {"http://", "https://", "src=", "<link"})
    EXPECT_EQ(html.find(outside), std::string::npos) << outside;
  for (const char* wrong : {"nan", "inf,"}) EXPECT_EQ(html.find(wrong), std::string::npos) << wrong;
  EXPECT_THAT(tradeoffHtml(Tradeoff()), HasSubstr("nothing to plot"));
}

}  // namespace
}  // namespace glint
