// SPDX-License-Identifier: BSD-3-Clause
// What one frame shows before anything is fitted to it, and earlier results held against it.
#include "core/pipeline/observation.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "tests/core/pipeline/exact_scene.h"
#include "tests/core/pipeline/questions.h"

namespace glint {
namespace {

using namespace testing_support;

constexpr int kFrame = 5;
constexpr double kLow = 0.2, kWider = 1.5;  // a second contour of this frame, at a lower level and so many times as large
constexpr double kSameContour = 5e-3;  // of an overlap: a model that is exact here predicts the given contour to its sampling
constexpr double kSamePlacePx = 0.1;   // the same, of where it lies

InspectionRequest observationRequest(double level = 0.5) {
  InspectionRequest q;
  q.models = {"limit-angle"};
  q.train = "first:4";
  q.settings.set("detect.level", level);
  return q;
}

std::shared_ptr<const Scene> twoLevels() {
  const auto scene = exactScene(sheet(0.3), 8);
  Highlight low = changed(scene->frames[kFrame].highlights.at(0), {{0, 0}, kWider, {0, 0}});
  low.level = kLow;
  scene->frames[kFrame].highlights.push_back(low);
  return scene;
}

const FrameComparison& comparisonOf(const Inspection& in) {
  for (const FrameComparison& c : in.models.at("limit-angle").frames)
    if (c.frame == kFrame) return c;
  throw std::out_of_range("no comparison of the frame");
}

TEST(ObserveFrame, IsWhatTheFrameShowsUnderTheRequest) {
  const auto scene = twoLevels();
  const std::optional<Observation> seen = observeFrame(scene, observationRequest(kLow), kFrame);
  ASSERT_TRUE(seen);
  EXPECT_EQ(seen->frame, kFrame);
  EXPECT_EQ(seen->scene, scene);
  ASSERT_EQ(seen->evidence.highlights.size(), 1u);
  EXPECT_EQ(seen->evidence.highlights[0].contour.points, scene->frames[kFrame].highlights[1].contour.points);
  EXPECT_TRUE(seen->inputs.same(Stage::Evidence, inspect(scene, observationRequest(kLow)).inputs));
}

TEST(ObserveFrame, NothingOfALightThatIsSwitchedOff) {
  const auto scene = twoLevels();
  const Inspection known = inspect(scene, observationRequest());
  InspectionRequest q = observationRequest(kLow);
  const std::string light = known.evidence[kFrame].highlights.at(0).light;
  q.whatIf = switched({}, *scene, kFrame, light, false);
  const std::optional<Observation> seen = observeFrame(scene, q, kFrame, {}, &known);
  ASSERT_TRUE(seen);
  EXPECT_TRUE(seen->evidence.highlights.empty());
  EXPECT_TRUE(besideObservation(known, *seen).models.at("limit-angle").frames.empty());
}

TEST(ObserveFrame, SaysNothingWhereItIsKnownOrTakesAllFrames) {
  const auto scene = twoLevels();
  const Inspection known = inspect(scene, observationRequest());
  InspectionRequest other = observationRequest();
  other.settings.set("light.robust_px", 3.0);
  EXPECT_FALSE(observeFrame(scene, other, kFrame, {}, &known)) << "nothing that is observed depends on it";
  EXPECT_TRUE(observeFrame(scene, observationRequest(kLow), kFrame, {}, &known));
  const Inspection one = inspectOneFrame(scene, observationRequest(), 6);
  EXPECT_TRUE(observeFrame(scene, observationRequest(), kFrame, {}, &one)) << "this frame was not looked at";
  const auto anotherScene = twoLevels();
  EXPECT_TRUE(observeFrame(anotherScene, observationRequest(), kFrame, {}, &known));

  auto lights = std::make_shared<Scene>(*scene);
  for (Frame& f : lights->frames) {
    f.lightsOn = {"lamp", "sun"};
    for (Highlight& h : f.highlights) h.light.clear();
  }
  EXPECT_FALSE(observeFrame(lights, observationRequest(kLow), kFrame)) << "which light it is, all frames tell";
}

TEST(ObserveFrame, SynthesisesTheContoursOfThatFrameAlone) {
  const auto scene = litScene(sphere(0.5), 8);
  InspectionRequest q = observationRequest();
  q.whatIf.synthesise = true;
  q.whatIf.lightsBy["lamp"] = {0.05, 0, 0};
  const auto all = changedScene(*scene, q.whatIf, 0.5);
  const std::optional<Observation> seen = observeFrame(scene, q, kFrame);
  ASSERT_TRUE(seen);
  ASSERT_EQ(seen->evidence.highlights.size(), all->frames[kFrame].highlights.size());
  EXPECT_EQ(seen->evidence.highlights.at(0).contour.points, all->frames[kFrame].highlights.at(0).contour.points);
  for (std::size_t i = 0; i < seen->scene->frames.size(); ++i)
    EXPECT_EQ(seen->scene->frames[i].highlights.empty(), int(i) != kFrame) << i;
}

TEST(ObserveFrame, StopsWhenAskedAndRefusesAFrameThatDoesNotExist) {
  const auto scene = twoLevels();
  EXPECT_THROW((void)observeFrame(scene, observationRequest(), kFrame, [](const StageEvent&) { return false; }), Stopped);
  EXPECT_THROW((void)observeFrame(scene, observationRequest(), 8), std::invalid_argument);
}

TEST(BesideObservation, TheEarlierPredictionIsComparedWithNothing) {
  const auto scene = twoLevels();
  const Inspection earlier = inspect(scene, observationRequest());
  ASSERT_TRUE(comparisonOf(earlier).rows.at(0).metrics);
  ASSERT_NEAR(comparisonOf(earlier).rows[0].metrics->iou, 1, kSameContour);
  const std::optional<Observation> seen = observeFrame(scene, observationRequest(kLow), kFrame, {}, &earlier);
  ASSERT_TRUE(seen);
  const Inspection now = besideObservation(earlier, *seen);
  EXPECT_EQ(now.request, observationRequest(kLow));
  EXPECT_EQ(now.evidence.at(kFrame).highlights.size(), 1u);
  EXPECT_EQ(now.evidence.at(0).frame, -1);
  EXPECT_TRUE(now.models.at("limit-angle").oneFrame);
  ASSERT_EQ(now.models.at("limit-angle").frames.size(), 1u);
  const FrameComparison& c = comparisonOf(now);
  EXPECT_EQ(c.prediction.highlights().at(0).contour.points, comparisonOf(earlier).prediction.highlights().at(0).contour.points);
  EXPECT_TRUE(c.rows.empty()) << "an error between an old prediction and a new contour is of no state";
}

TEST(BesideObservation, HighlightsMovedByHandStayMoved) {
  const auto scene = twoLevels();
  const Inspection earlier = inspect(scene, observationRequest());
  InspectionRequest q = observationRequest(kLow);
  q.whatIf.highlights[{kFrame, 0}].contourBy = {3, -4};
  q.whatIf.highlights[{kFrame, 7}].contourBy = {100, 0};  // of a highlight that is missing
  q.whatIf.highlights[{0, 0}].contourBy = {100, 0};       // of another frame
  const std::optional<Observation> seen = observeFrame(scene, q, kFrame, {}, &earlier);
  ASSERT_TRUE(seen);
  const Inspection now = besideObservation(earlier, *seen);
  const auto middleOf = [](const Inspection& in) { return centroid(in.evidence.at(kFrame).highlights.at(0).contour); };
  EXPECT_NEAR((middleOf(now) - middleOf(earlier)).norm(), 5, kSamePlacePx);
}

TEST(BesideObservation, WhereNothingIsObservedTheReasonIsThere) {
  const auto scene = twoLevels();
  const Inspection earlier = inspect(scene, observationRequest());
  const std::optional<Observation> seen =
      observeFrame(scene, observationRequest(0.7), kFrame, {}, &earlier);  // a level without a contour
  ASSERT_TRUE(seen);
  ASSERT_TRUE(seen->evidence.failure);
  const Inspection now = besideObservation(earlier, *seen);
  EXPECT_TRUE(now.evidence.at(kFrame).failure);
  EXPECT_TRUE(comparisonOf(now).rows.empty());
}

TEST(BesideObservation, RefusesResultsOfAnotherScene) {
  const Inspection earlier = inspect(twoLevels(), observationRequest());
  const std::optional<Observation> seen = observeFrame(twoLevels(), observationRequest(kLow), kFrame);
  ASSERT_TRUE(seen);
  EXPECT_THROW((void)besideObservation(earlier, *seen), std::invalid_argument);
}

}  // namespace
}  // namespace glint
