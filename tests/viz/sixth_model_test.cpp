// SPDX-License-Identifier: BSD-3-Clause
// A model is one file: this one is known to every table, check, explanation and picture without another line elsewhere.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "core/advise/conditioning.h"
#include "core/advise/explain.h"
#include "core/choice/tradeoff.h"
#include "core/draw/frame_overlay.h"
#include "core/model/models.h"
#include "core/report/report.h"
#include "plugins/example/flat_mirror.h"
#include "tests/core/pipeline/exact_scene.h"
#include "viz/pictures.h"
#include "viz/style.h"

namespace glint {
namespace {

using namespace testing_support;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

class SixthModel : public testing::Test {
 protected:
  static void SetUpTestSuite() { addModel(std::make_unique<example::FlatMirror>()); }
  static Inspection inspected(const AnalyticSpec& surface) {
    InspectionRequest request;
    request.train = "spread:6";
    request.models = {"primal", "limit-angle", "flat-mirror"};
    return inspect(exactScene(surface, 10), request);
  }
};

TEST_F(SixthModel, IsAmongAllModels) {
  EXPECT_THAT(modelIds(), Contains("flat-mirror"));
  EXPECT_THAT(InspectionRequest().models, Contains("flat-mirror"));
  EXPECT_THROW(addModel(std::make_unique<example::FlatMirror>()), std::invalid_argument);
}

// On a plane it is the limit angle itself.
TEST_F(SixthModel, IsScoredAndReported) {
  const Inspection in = inspected(sheet(0));
  EXPECT_THAT(modelsInOrder(in, {}), ElementsAre("primal", "limit-angle", "flat-mirror"));
  const auto report = nlohmann::json::parse(evaluationJson(in, {}));
  constexpr double kSamePct = 0.05;  // 72 against 360 vertices
  EXPECT_LT(report["models"]["flat-mirror"]["summary"]["contour_error_pct"]["mean"].get<double>(), kSamePct);
  EXPECT_THAT(evaluationTable(in), HasSubstr("flat-mirror"));
  EXPECT_THAT(evaluationCsv(in), HasSubstr("flat-mirror"));
  EXPECT_THAT(evaluationHtml(in, {}), HasSubstr("flat-mirror"));
}

TEST_F(SixthModel, IsCheckedAndExplained) {
  const Inspection in = inspected(sphere(0.5));
  const std::vector<Conditioning> all = conditioningOf(in);
  EXPECT_TRUE(
      std::any_of(all.begin(), all.end(), [](const Conditioning& c) { return c.model == "flat-mirror" && !c.findings.empty(); }));
  // What its traits say it assumes is said where the surface breaks it.
  const Explanation e = explain(in, 1, 0, "flat-mirror");
  EXPECT_FALSE(e.steps.empty());
  bool said = false;
  for (const ExplainStep& step : e.steps)
    for (const auto& broken : step.broken) said = said || broken.id == "primal-off-plane";
  EXPECT_TRUE(said);
}

TEST_F(SixthModel, IsDrawnInItsColour) {
  EXPECT_EQ(draw::modelColour("flat-mirror"), (draw::Colour{240 / 255.0, 228 / 255.0, 66 / 255.0}));
  const Inspection in = inspected(sphere(0.5));
  const draw::FrameOverlay overlay = draw::frameOverlay(in, 1, {});
  EXPECT_TRUE(std::any_of(overlay.lines.begin(), overlay.lines.end(),
                          [](const draw::OverlayLine& l) { return l.model == "flat-mirror"; }));
  const Image ladder = viz::ladderPicture(in, 1, Failure{Reason::FrameUnreadable, ""}, 900, 500),
              plots = viz::plotsPicture(in, 900, 600);
  EXPECT_EQ(ladder.width, 900);
  EXPECT_EQ(plots.width, 900);
}

}  // namespace
}  // namespace glint
