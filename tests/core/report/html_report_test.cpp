// SPDX-License-Identifier: BSD-3-Clause
// What the report says in words: what was computed with, and what there is no number for.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <regex>

#include "core/base/html_text.h"
#include "core/report/report.h"
#include "tests/core/pipeline/exact_scene.h"

namespace glint {
namespace {

using namespace testing_support;
using testing::HasSubstr;
using testing::Not;

Inspection sheetRun() {
  InspectionRequest q;
  q.models = {"dual"};
  q.train = "first:4";
  q.settings.set("fit.solver", std::string("linear"));
  return inspect(exactScene(sheet(0), 6), q);
}

TEST(HtmlReport, NamesWhatWasMissedAndWhy) {
  Inspection run = sheetRun();
  EXPECT_THAT(evaluationHtml(run, {}), Not(HasSubstr(" missed</td>")));
  for (FrameComparison& c : run.models.at("dual").frames) {
    if (c.frame != 0 && c.frame != 5) continue;  // 0 trains: it is not part of what the report is about
    ASSERT_FALSE(c.rows.empty());
    c.rows[0].metrics.reset();
    c.rows[0].failure = Failure{Reason::NotReached, "frame " + std::to_string(c.frame) + " <went astray>"};
  }
  const std::string html = evaluationHtml(run, {});
  EXPECT_THAT(html, HasSubstr("<td>1 missed</td>"));
  EXPECT_THAT(html, HasSubstr("frame 5 &lt;went astray&gt;</td><td class=\"text\">v5</td>"));
  EXPECT_THAT(html.substr(html.find("Models</h2>")), Not(HasSubstr("frame 0 &lt;went")));
  EXPECT_THAT(html.substr(html.find("Worst frames")), HasSubstr("<b>frame v5</b>")) << "it is shown, and first";
  const std::string worst = html.substr(html.find("Worst frames"));
  EXPECT_LT(worst.find("<b>frame v5</b>"), worst.find("<b>frame v4</b>"));
  EXPECT_THAT(html, HasSubstr("<b>Missed</b>, <b>frame v5</b>")) << "the summary shows it, too";
}

TEST(HtmlReport, WhatIsMissedForOneReasonIsOneRow) {
  Inspection run = sheetRun();
  for (FrameComparison& c : run.models.at("dual").frames) {
    c.rows.at(0).metrics.reset();
    c.rows[0].failure = Failure{Reason::NotReached, "the same"};
  }
  const std::string html = evaluationHtml(run, {});
  EXPECT_THAT(html, HasSubstr("<td>2 missed</td>"));
  EXPECT_THAT(html, HasSubstr(">v4, v5</td>"));
}

/// Words of models come from the models themselves, so that they are the same everywhere.
TEST(HtmlReport, BeginsInWordsAndExplainsTheModels) {
  ReportContext context;
  context.input = "a & b";
  const std::string html = evaluationHtml(sheetRun(), context);
  const std::size_t inShort = html.find("In short"), doubt = html.find("What to doubt"), table = html.find("Numbers</h2>");
  ASSERT_NE(inShort, std::string::npos);
  EXPECT_LT(inShort, doubt);
  EXPECT_LT(doubt, table);
  EXPECT_THAT(html.substr(inShort, doubt - inShort), HasSubstr("dual: its contours are off by "));
  EXPECT_THAT(html.substr(inShort, doubt - inShort), HasSubstr("<svg")) << "and in pictures";
  EXPECT_THAT(html, HasSubstr(html::escaped(modelByName("dual").assumption())));
  EXPECT_THAT(html, HasSubstr("content=\"light\"")) << "it is printed: a dark page would waste ink";
}

/// Relative luminance and contrast of the Web Content Accessibility Guidelines 2.1, which ask for 4.5 : 1. The darkest ground of
/// a text on the page is the box of the summary.
TEST(HtmlReport, EveryTextIsReadable) {
  const auto luminance = [](const std::string& hex) {
    double sum = 0;
    for (int k = 0; k < 3; ++k) {
      const std::string digits = hex.size() == 3 ? std::string(2, hex[std::size_t(k)]) : hex.substr(std::size_t(2 * k), 2);
      const double v = std::stoi(digits, nullptr, 16) / 255.0;
      sum += (k == 0 ? 0.2126 : k == 1 ? 0.7152 : 0.0722) * (v <= 0.03928 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4));
    }
    return sum;
  };
  EXPECT_NEAR(1.05 / (luminance("767676") + 0.05), 4.54, 0.005) << "a well-known grey on white";
  const std::string html = evaluationHtml(sheetRun(), {});
  const std::string style = html.substr(0, html.find("</style>"));
  const std::regex colour("[{;]color:#([0-9a-f]+)");
  int found = 0;
  for (std::sregex_iterator it(style.begin(), style.end(), colour), end; it != end; ++it, ++found)
    EXPECT_GE((luminance("f4f6f8") + 0.05) / (luminance((*it)[1]) + 0.05), 4.5) << (*it)[1];
  EXPECT_GE(found, 4);
  EXPECT_THAT(style, HasSubstr(".short{background:#f4f6f8"));
}

TEST(HtmlReport, GroupsTheRowsOfAModelByLight) {
  EXPECT_THAT(evaluationHtml(sheetRun(), {}), Not(HasSubstr("class=\"part\""))) << "one light needs no row of its own";
  Inspection run = sheetRun();
  std::vector<FrameComparison>& frames = run.models.at("dual").frames;
  const std::vector<FrameComparison> first = frames;
  for (FrameComparison c : first) {
    c.light = "<second>";
    c.rows.at(0).metrics->contourErrorPct = 12.5;
    frames.push_back(c);
  }
  const std::string html = evaluationHtml(run, {});
  EXPECT_THAT(html, HasSubstr("<td class=\"part\">light &lt;second&gt;</td><td>2/2</td><td>12.5</td><td>12.5</td>"));
}

/// The mean over what was matched would make the frame with the miss the best of all.
TEST(HtmlReport, AFrameWithAMissHasACrossAndNoErrorInThePlot) {
  Inspection run = sheetRun();
  EXPECT_THAT(evaluationHtml(run, {}), Not(HasSubstr("missed a highlight")));
  run.evidence[5].highlights.push_back(run.evidence[5].highlights.at(0));
  for (FrameComparison& c : run.models.at("dual").frames) {
    if (c.frame != 5) continue;
    c.rows.at(0).metrics->contourErrorPct = 1e-6;
    c.rows.push_back({1, -1, {}, Failure{Reason::NotReached, "no prediction overlaps this highlight"}, {}});
  }
  const std::string html = evaluationHtml(run, {});
  EXPECT_THAT(html, HasSubstr("<title>frame v5 (held out)\ndual  missed 1 of 2 highlights"));
  EXPECT_THAT(html, HasSubstr(">missed a highlight</text>")) << "the legend says what the cross is";
  EXPECT_THAT(html, Not(HasSubstr("dual  1e-06 %")));
  EXPECT_THAT(html, HasSubstr("<title>frame v4 (held out)\ndual  "));
}

/// The legend of the plot, the table and the sentence speak of the same highlights: those that were found, and it says how many
/// were not.
TEST(HtmlReport, LegendTableAndSentenceHaveOneMean) {
  InspectionRequest q;
  q.models = {"dual"};
  q.train = "first:4";
  Inspection run = inspect(exactScene(sheet(0), 9), q);  // 4 to 8 are held out
  int found = 0;
  for (FrameComparison& c : run.models.at("dual").frames) {
    if (c.frame < 4) continue;
    c.rows.at(0).metrics->contourErrorPct = 10 * (c.frame - 3);  // 10, 20, 30, 40, 50
    if (c.frame < 7) c.rows.push_back({1, -1, {}, Failure{Reason::NotReached, "no prediction overlaps this highlight"}, {}});
    found += 1;
  }
  ASSERT_EQ(found, 5);
  const std::string html = evaluationHtml(run, {});
  EXPECT_THAT(html, HasSubstr(">dual: mean 30 % over 5 of 8 held-out highlights, 3 missed</text>"));
  EXPECT_THAT(html, HasSubstr("</span>dual</td><td>5/5</td><td>30</td>"));
  EXPECT_THAT(html, HasSubstr("<td>5 / 3 / 0</td>"));
  EXPECT_THAT(html, HasSubstr("off by 30 % of a highlight"));
  EXPECT_THAT(html, HasSubstr("Of 8 highlights in 5 held-out frames it missed 3 (frames v4, v5, v6)"));
  EXPECT_THAT(evaluationTable(run), testing::ContainsRegex("dual +5/5 +30[.]000 .* 5/3/0 "));
}

TEST(HtmlReport, SaysWithWhichSettingsAndByWhich) {
  ReportContext context;
  context.program = "glint 0 & more";
  const std::string html = evaluationHtml(sheetRun(), context);
  for (const ParamSpec& p : allParams()) EXPECT_THAT(html, HasSubstr("<code>" + p.key + "</code>"));
  EXPECT_THAT(html, HasSubstr("<b>linear</b>")) << "what differs from the default stands out";
  EXPECT_THAT(html, HasSubstr("Made by glint 0 &amp; more."));
  EXPECT_THAT(html, Not(HasSubstr("src=\"http"))) << "nothing is fetched";
}

}  // namespace
}  // namespace glint
