// SPDX-License-Identifier: BSD-3-Clause
// The automatic choice on scenes where the right answer follows from what the models assume (method.md section 7).
#include "core/pipeline/selection.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <set>

#include "tests/core/pipeline/exact_scene.h"

namespace glint {
namespace {
using namespace testing_support;
using testing::HasSubstr;

Inspection evidenceOf(std::shared_ptr<const Scene> scene, const std::string& train, double noisePx = 0) {
  InspectionRequest request;
  request.models.clear();
  request.train = train;
  request.noisePx = noisePx;
  return inspect(std::move(scene), request);
}

Selection choiceOn(const AnalyticSpec& spec, std::optional<double> goodEnough = {}, double noisePx = 0) {
  return selectModel(evidenceOf(exactScene(spec, 8), "spread:6", noisePx), goodEnough);
}

const Candidate& candidate(const Selection& s, const std::string& model) {
  return *std::find_if(s.candidates.begin(), s.candidates.end(), [&](const Candidate& c) { return c.model == model; });
}

// method.md section 11: a noise-free plane gives `primal`.
TEST(SelectModel, APlaneNeedsOnlyTheCamera) {
  const Selection s = choiceOn(sheet(0));
  EXPECT_EQ(s.model, "primal") << selectionTable(s);
  EXPECT_EQ(s.candidates.size(), 1u) << "nothing can be better by more than contours resolve, so nothing richer is computed";
  EXPECT_THAT(s.why, HasSubstr("Richer models were not tried"));
}

TEST(SelectModel, APlaneWithAToleranceNeedsOnlyTheCamera) {
  const Selection s = choiceOn(sheet(0), 0.5);
  EXPECT_EQ(s.model, "primal") << s.why;
  EXPECT_EQ(s.candidates.size(), 1u) << "nothing richer is computed";
}

TEST(SelectModel, NoiseMakesRicherModelsUseless) {
  for (const double noise : {0.5, 2.0}) {
    const Selection s = choiceOn(sheet(0), {}, noise);
    EXPECT_EQ(s.model, "primal") << selectionTable(s);
  }
}

TEST(SelectModel, ASphereNeedsTheLevelSet) {
  const Selection s = choiceOn(sphere(0.5));
  EXPECT_EQ(s.model, "limit-angle") << selectionTable(s);
  EXPECT_GT(candidate(s, "dual").meanPct, kNegligiblePct);
}

TEST(SelectModel, ASphereWithATightToleranceNeedsTheLevelSet) {
  const Selection s = choiceOn(sphere(0.5), 0.05);
  EXPECT_EQ(s.model, "limit-angle") << s.why;
  EXPECT_EQ(s.candidates.size(), 4u);
  EXPECT_THAT(s.why, HasSubstr("tolerance of 0.05 %"));
}

// The tolerance decides, not the name: an ellipsoid is taken exactly where its error is under it.
TEST(SelectModel, ASphereGivesAnEllipsoidOnlyWithAToleranceAboveItsError) {
  const Selection all = choiceOn(sphere(0.5));
  double smallest = 1e300;
  std::string which;
  for (const char* model : {"primal", "dual", "canonical"})
    if (candidate(all, model).meanPct < smallest) smallest = candidate(all, model).meanPct, which = model;
  EXPECT_EQ(choiceOn(sphere(0.5), smallest * 1.01).model, which);
  EXPECT_EQ(choiceOn(sphere(0.5), smallest * 0.99).model, "limit-angle");
}

TEST(SelectModel, ACylinderNeedsTheLevelSet) {
  const Selection s = choiceOn(cylinder(0.4));
  EXPECT_EQ(s.model, "limit-angle") << selectionTable(s);
}

TEST(SelectModel, NoToleranceThatIsMetSaysSo) {
  const Selection s = choiceOn(sphere(0.5), {}, 1.0);
  const Selection strict = choiceOn(sphere(0.5), 1e-6, 1.0);
  EXPECT_EQ(strict.model, s.model);
  EXPECT_THAT(strict.why, HasSubstr("No model reached the stated tolerance of 1e-06 %."));
}

TEST(SelectModel, TwoLightsAreLeftOutTogether) {
  const auto scene = exactScene(sheet(0), {{"a", {0.1, 0.2, 1.4}}, {"b", {-0.25, 0.1, 1.5}}}, 6, [](int) {
    return std::vector<std::string>{"a", "b"};
  });
  const Selection s = selectModel(evidenceOf(scene, "spread:6"), {});
  EXPECT_EQ(s.leftOut, 12) << "one highlight of each light in each frame";
  EXPECT_EQ(s.model, "primal") << selectionTable(s);
}

// Trained on the flat sheet alone `primal` is perfect there and useless on the bent one, which leaving views out cannot see.
TEST(SelectModel, AnEllipsoidOfTheSeenSurfaceDoesNotCarryOver) {
  auto scene = exactScene(sheet(0), 6);
  const auto bent = exactScene(sheet(1.5), 6);
  scene->surfaces["bent"].analytic = sheet(1.5);
  for (Frame f : bent->frames) {
    f.id += "bent";
    f.surface = "bent";
    scene->frames.push_back(f);
  }
  const Selection s = selectModel(evidenceOf(scene, "0-5"), {});
  EXPECT_EQ(s.model, "canonical") << selectionTable(s);
  EXPECT_THAT(candidate(s, "primal").remark, HasSubstr("surfaces that no training view shows"));
  EXPECT_LT(candidate(s, "primal").meanPct, kNegligiblePct) << "so leaving views out alone would have taken it";
  const Selection easy = selectModel(evidenceOf(scene, "0-5"), 50.0);
  EXPECT_EQ(easy.model, "canonical") << "no tolerance makes up for that";
  const Selection known = selectModel(evidenceOf(scene, "0-11"), 0.5);
  EXPECT_NE(known.model, "primal");
}

// The work grows with the views, not with their square.
TEST(SelectModel, LeavesAtMostSomeViewsOut) {
  const Selection s = selectModel(evidenceOf(exactScene(sheet(0), 30), "spread:30"), 0.5);
  EXPECT_EQ(s.trainingViews, 30);
  EXPECT_EQ(s.leftOut, kMostLeftOut);
  EXPECT_THAT(selectionTable(s), HasSubstr("24 of 30 training views were left out one at a time"));
}

TEST(SelectModel, NothingToLeaveOut) {
  const Selection one = selectModel(evidenceOf(exactScene(sheet(0), 4), "0"), {});
  EXPECT_EQ(one.model, "");
  EXPECT_THAT(one.candidates[0].remark, HasSubstr("too few views"));
  auto blind = exactScene(sheet(0), 4);
  for (Frame& f : blind->frames) f.highlights.clear();
  const Selection none = selectModel(evidenceOf(blind, "spread:4"), {});
  EXPECT_EQ(none.model, "");
  EXPECT_EQ(none.why, "There is no training view to leave out.");
}

// Three views: `canonical` cannot be fitted to the two that stay, `limit-angle` can.
TEST(SelectModel, AModelMustAnswerWhatAnotherAnswers) {
  const Selection s = selectModel(evidenceOf(exactScene(sphere(0.5), 3), "spread:3"), {});
  EXPECT_EQ(s.model, "limit-angle") << selectionTable(s);
  EXPECT_EQ(candidate(s, "canonical").answered, 0);
  EXPECT_THAT(candidate(s, "canonical").remark, HasSubstr("too few views"));
}

TEST(SelectModel, StopsWhenAsked) {
  const Inspection inspection = evidenceOf(exactScene(sheet(0), 6), "spread:6");
  EXPECT_THROW(selectModel(inspection, {}, [](const StageEvent&) { return false; }), Stopped);
}

}  // namespace
}  // namespace glint
