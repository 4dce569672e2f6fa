// SPDX-License-Identifier: BSD-3-Clause
// A poor fit answers: every table, file and page shows its numbers, says that it is poor, and why.
#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/model/plausible.h"
#include "core/report/labels.h"
#include "core/report/report.h"
#include "core/report/share.h"
#include "core/report/texts.h"
#include "tests/core/pipeline/exact_scene.h"

namespace glint::poor_fits_tests {

using namespace testing_support;
using nlohmann::json;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

constexpr const char* kWhy = "4 px remain in the training views";

/// Dual is poor, primal is ok.
Inspection run() {
  InspectionRequest q;
  q.models = {"primal", "dual"};
  q.train = "first:4";
  Inspection run = inspect(exactScene(sheet(0), 6), q);
  for (ModelResult::Fit& fit : run.models.at("dual").fits) fit.fit->poor = kWhy;
  return run;
}

TEST(PoorFits, EvaluationFilesSayItAndGiveTheNumbers) {
  const Inspection r = run();
  const json dual = json::parse(evaluationJson(r, {}))["models"]["dual"];
  EXPECT_EQ(dual["status"], "poor");
  EXPECT_EQ(dual["reason"], kWhy);
  EXPECT_EQ(dual["fits"][0]["status"], "poor");
  EXPECT_EQ(dual["fits"][0]["reason"], kWhy);
  EXPECT_TRUE(dual["summary"]["contour_error_pct"]["mean"].is_number());
  for (const json& row : dual["frames"]) {
    EXPECT_EQ(row["status"], "poor");
    EXPECT_EQ(row["reason"], kWhy);
    EXPECT_TRUE(row["contour_error_pct"].is_number());
  }
  EXPECT_EQ(json::parse(evaluationJson(r, {}))["models"]["primal"]["status"], "ok");
  EXPECT_THAT(evaluationCsv(r), testing::ContainsRegex(std::string("dual,4,v4,lamp,0,poor,") + kWhy + ",[0-9]"));
  EXPECT_THAT(evaluationTable(r), testing::ContainsRegex(std::string("dual +2/2 +[0-9].* poor: ") + kWhy));
  EXPECT_THAT(warningsOf(r), Contains("dual, light lamp: poor: " + std::string(kWhy)));
}

TEST(PoorFits, PagesSayItAndGiveTheNumbers) {
  const Inspection r = run();
  const std::string html = evaluationHtml(r, {});
  EXPECT_THAT(html, testing::ContainsRegex("<tr class=\"poor\"><td>[^\n]*dual[^\n]*<td>2/2</td><td>[0-9]"));
  EXPECT_THAT(html, HasSubstr("<b>Poor answer:</b> " + std::string(kWhy)));
  const std::string page = sharePage(r, {}, {});
  const std::size_t at = page.find("id=\"data\">") + 10;
  const json data = json::parse(page.substr(at, page.find("</script>", at) - at));
  EXPECT_EQ(data["evaluation"]["models"]["dual"]["status"], "poor");
  EXPECT_EQ(data["evaluation"]["models"]["dual"]["reason"], kWhy);
  // Dashed and pale over the photograph and on the surface; frame 0 trains, where an ok fit is solid.
  const std::string full = data["models"][1]["colour"];
  ASSERT_EQ(data["models"][1]["id"], "dual");
  int lines = 0, contours = 0;
  for (const json& frame : data["frames"]) {
    for (const json& line : frame["lines"]) {
      if (line["model"] == "primal") EXPECT_EQ(line["dash"], frame["role"] == "training" ? 0 : 1);
      if (line["model"] != "dual") continue;
      ++lines;
      EXPECT_EQ(line["dash"], 1);
      EXPECT_NE(line["colour"], full);
    }
    for (const json& thing : frame["things"]) {
      if (thing["role"] != "predicted-contour") continue;
      ++contours;
      EXPECT_EQ(thing.value("poor", false), thing["model"] == "dual");
      if (thing["model"] == "dual") EXPECT_NE(thing["colour"], full);
      if (thing["model"] == "primal") EXPECT_EQ(thing["colour"], data["models"][0]["colour"]);
    }
  }
  EXPECT_EQ(lines, 6);
  EXPECT_EQ(contours, 12);
}

TEST(PoorFits, PredictionsAndLabelsSayIt) {
  const Inspection r = run();
  const json rows = json::parse(predictionsJson(r, {4, 5}))["models"];
  EXPECT_EQ(rows["dual"][0]["status"], "poor");
  EXPECT_EQ(rows["dual"][0]["reason"], kWhy);
  EXPECT_FALSE(rows["dual"][0]["highlights"].empty());
  EXPECT_EQ(rows["primal"][0]["status"], "ok");
  EXPECT_EQ(rows["primal"][0]["reason"], "");
  EXPECT_EQ(json::parse(cocoJson(r, "dual", {4}))["info"]["reason"], kWhy);
  EXPECT_FALSE(json::parse(cocoJson(r, "primal", {4}))["info"].contains("reason"));
}

/// A live pose is poor if no fit that answers is ok.
TEST(PoorFits, LiveAnswersSayIt) {
  const Inspection r = run();
  LivePose pose;
  pose.id = "x";
  const auto of = [&](const std::string& model, const char* poor) {
    return LiveHighlights{model, "lamp", r.models.at(model).frames.at(4).prediction, poor};
  };
  LiveAnswer answer;
  answer.camera = r.scene->frames[4].camera;
  answer.highlights = {of("dual", kWhy)};
  const json alone = json::parse(liveLine(pose, answer, 1));
  EXPECT_EQ(alone["status"], "poor");
  EXPECT_EQ(alone["reason"], "dual: " + std::string(kWhy));
  EXPECT_EQ(alone["highlights"][0]["status"], "poor");
  answer.highlights.push_back(of("primal", ""));
  const json both = json::parse(liveLine(pose, answer, 1));
  EXPECT_EQ(both["status"], "ok");
  EXPECT_EQ(both["reason"], "");
  EXPECT_EQ(both["highlights"][1]["status"], "ok");
}

/// What is said of one view names its frame as the scene does.
TEST(PoorFits, RemarksNameFramesByTheirIds) {
  ModelFit fit;
  fit.frames = {0, 1, 2, 3};
  fit.residualPx = {0.1, 0.1, 9, 0.1};
  std::vector<UsedContour> used(4, UsedContour{20, 0, 1});
  for (std::size_t i = 0; i < used.size(); ++i) used[i].frame = "00" + std::to_string(10 + 2 * i);
  const Outcome<ModelFit> judged = explaining(fit, used, true, 0.1);
  ASSERT_TRUE(judged);
  EXPECT_THAT(judged->remarks, Contains(HasSubstr("frame 0014 is inconsistent")));
  fit.residualPx[2] = std::nan("");
  const Outcome<ModelFit> none = explaining(fit, used, true, 0.1);
  ASSERT_FALSE(none);
  EXPECT_THAT(none.failure().detail, HasSubstr("no highlight in training frame 0014"));
  // From a scene on: views know it.
  const Inspection r = run();
  for (const TrainingView& v : r.views) EXPECT_EQ(frameNameOf(v), r.scene->frames[std::size_t(v.frame)].id);
  std::vector<TrainingView> views = r.views;
  views[1].seen = Failure{Reason::OutsideImage, "cut"};
  EXPECT_THAT(unusedViews(views), HasSubstr("frame v1: outside image"));
  const Light below = Light::at({0, 0, -1});
  EXPECT_THAT(lightBehind(r.views, below)->detail, HasSubstr("first in frame v0"));
}

}  // namespace glint::poor_fits_tests
