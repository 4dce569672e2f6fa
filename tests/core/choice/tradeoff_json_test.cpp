// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <regex>

#include "core/base/html_text.h"
#include "core/base/outcome.h"
#include "core/choice/tradeoff.h"
#include "core/report/report.h"
#include "tests/core/choice/points.h"

namespace glint {
namespace {
using namespace testing_support;
using testing::HasSubstr;

Tradeoff example() {
  Tradeoff t;
  t.input = "a <b>";
  t.train = {0, 5};
  t.trainIds = {"0008", "0016"};
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
  EXPECT_EQ(j["train_ids"], (std::vector<std::string>{"0008", "0016"}));
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

/// Two settings; what the second one missed and what is spurious makes its error 78 %, though what it found is off by 38.1 %.
Tradeoff twoWithMisses() {
  Tradeoff t;
  t.points = {point("dual", 8, 4), point("primal", 38.1, 2)};
  t.points[1].frames = t.points[1].predicted = 54;
  t.points[1].matched = 29;
  t.points[1].missed = 25;
  t.points[1].spurious = 27;
  t.points[1].rankedErrorPct = rankedErrorPct(t.points[1]);
  choosePoint(t, {});
  return t;
}

std::vector<std::string> allOf(const std::string& text, const char* pattern) {
  std::vector<std::string> found;
  const std::regex regex(pattern);
  for (std::sregex_iterator it(text.begin(), text.end(), regex), end; it != end; ++it) found.push_back((*it)[1]);
  return found;
}

/// One error of a setting, whether a plot, a table, the sentence of the choice or the bound of --max-error-pct says it. Beside
/// it, by name, that of the highlights that were found, and how many these are.
TEST(TradeoffHtml, PlotTableAndSentenceShowOneError) {
  const Tradeoff t = twoWithMisses();
  const double ranked = (29 * 38.1 + (25 + 27) * 100.0) / 81;
  const std::string html = tradeoffHtml(t), rank = html::format("%.3g", ranked);
  EXPECT_EQ(rank, "77.8");
  const std::vector<std::string> plotted = allOf(html, "<title>[^<]*\nerror ([0-9.e+-]+) %"),
                                 listed = allOf(html, "</span>[^<]*</td><td>[0-9.]+</td><td>([0-9.e+-]+)</td>");
  EXPECT_THAT(listed, testing::ElementsAre(rank, "8"));
  EXPECT_THAT(plotted, testing::IsSupersetOf({rank, std::string("8")}));
  EXPECT_THAT(html, HasSubstr("<td>29 of 54</td><td>38.1</td><td>27</td>"));
  EXPECT_THAT(html, HasSubstr("found 29 of 54 highlights with 38.1 %, 27 spurious"));
  EXPECT_THAT(html, testing::Not(HasSubstr("54/54"))) << "frames with some prediction read as if nothing was missed";
  const std::string table = tradeoffTable(t);
  EXPECT_THAT(table, testing::ContainsRegex("\\* +2[.]0 +77[.]8 +29/54 +38[.]1 "));
  EXPECT_THAT(t.reason, HasSubstr("dual (8 % at 4 us per frame)"));
  Tradeoff bound = t;
  choosePoint(bound, {.maxErrorPct = 50});
  EXPECT_EQ(bound.points[*bound.chosen].model, "dual") << "38.1 % is that of what was found alone";
  EXPECT_THAT(bound.reason, HasSubstr("the next faster one, primal (77.8 % at 2 us per frame), is over that error"));
}

/// Presets that are one setting have one mark, and a sentence says so.
TEST(TradeoffHtml, PresetsThatCoincideAreSaidToBeOne) {
  const Tradeoff t = twoWithMisses();  // the only usable setting
  EXPECT_EQ(t.presets, (std::map<std::string, int>{{"fast", 1}, {"balanced", 1}, {"exact", 1}}));
  EXPECT_EQ(presetNames(t, 1), "fast, balanced and exact");
  EXPECT_EQ(presetNames(t, 0), "");
  const std::string note = "The presets fast, balanced and exact are the same setting";
  for (const std::string& text : {tradeoffHtml(t), tradeoffTable(t)}) EXPECT_THAT(text, HasSubstr(note));
  EXPECT_THAT(tradeoffHtml(t), HasSubstr(">fast, balanced and exact (chosen)</text>"));
  Tradeoff two;
  two.points = {point("dual", 4, 4), point("canonical", 3.9, 400), point("primal", 20, 1)};
  choosePoint(two, {});
  EXPECT_EQ(presetNames(two, two.presets.at("fast")), "fast and balanced");
  EXPECT_EQ(presetNote(two), "The presets fast and balanced are the same setting: no slower one is a better compromise.");
  EXPECT_THAT(two.reason, HasSubstr("exact: canonical (3.9 % at 400 us per frame)"));
  EXPECT_THAT(two.reason, testing::Not(HasSubstr("fast:"))) << "the sentence beside it says it";
  Tradeoff three;
  three.points = {point("primal", 9, 1), point("dual", 3, 3), point("canonical", 1, 100)};
  choosePoint(three, {});
  EXPECT_EQ(presetNote(three), "") << "each is a setting of its own";
  EXPECT_THAT(tradeoffTable(three), HasSubstr("<- exact"));
}

/// A person reads which frames trained by their ids.
TEST(TradeoffHtml, NamesTrainingFramesByTheirIds) {
  EXPECT_THAT(tradeoffHtml(example()), HasSubstr("training <code>0008, 0016</code> (2 frames)"));
  Tradeoff rule = example();
  rule.trainSpec = "first:2";
  EXPECT_THAT(tradeoffHtml(rule), HasSubstr("<code>first:2, 0008, 0016</code>"));
}

}  // namespace
}  // namespace glint
