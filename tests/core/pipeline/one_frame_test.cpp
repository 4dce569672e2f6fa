// SPDX-License-Identifier: BSD-3-Clause
// One frame first, the rest after it: never another result than everything at once.
#include <gtest/gtest.h>

#include "core/app/session.h"
#include "core/pipeline/photograph.h"
#include "tests/core/pipeline/exact_scene.h"
#include "tests/core/pipeline/questions.h"

namespace glint {
namespace {

using namespace testing_support;

const NamedLight kOneFrameLeft{"left", {-0.25, 0.1, 1.4}}, kOneFrameRight{"right", {0.3, 0.0, 1.3}};

InspectionRequest oneFrameRequest() {
  InspectionRequest q;
  q.train = "first:4";
  return q;
}

/// What the whole run says about one frame.
void expectSameFrame(const Inspection& one, const Inspection& all, int frame) {
  ASSERT_EQ(one.models.size(), all.models.size());
  for (const auto& [name, model] : all.models) {
    const ModelResult& there = one.models.at(name);
    std::vector<const FrameComparison*> wanted, got;
    for (const FrameComparison& c : model.frames)
      if (c.frame == frame) wanted.push_back(&c);
    for (const FrameComparison& c : there.frames)
      if (c.frame == frame) got.push_back(&c);
    ASSERT_EQ(got.size(), wanted.size()) << name;
    for (std::size_t i = 0; i < got.size(); ++i) {
      EXPECT_EQ(got[i]->iou, wanted[i]->iou) << name;
      ASSERT_EQ(got[i]->prediction.highlights().size(), wanted[i]->prediction.highlights().size()) << name;
      for (std::size_t h = 0; h < got[i]->prediction.highlights().size(); ++h)
        EXPECT_EQ(got[i]->prediction.highlights()[h].contour.points, wanted[i]->prediction.highlights()[h].contour.points)
            << name;
    }
  }
}

TEST(InspectOneFrame, LooksAtTheTrainingFramesAndThatOneAndTheRestIsAddedLater) {
  const auto scene = exactScene(sheet(0.3), 12);
  const Inspection all = inspect(scene, oneFrameRequest());
  const Inspection one = inspectOneFrame(scene, oneFrameRequest(), 9);
  EXPECT_EQ(one.work.framesDetected, 5);
  EXPECT_EQ(one.work.predictions, all.work.predictions / 12);
  EXPECT_EQ(one.evidence[9].frame, 9);
  EXPECT_EQ(one.evidence[8].frame, -1);
  expectSameFrame(one, all, 9);

  const Inspection rest = inspect(scene, oneFrameRequest(), {}, &one);
  EXPECT_EQ(digestOf(rest), digestOf(all));
  EXPECT_EQ(rest.work.framesDetected, 7);
  EXPECT_EQ(rest.work.fits + rest.work.lights + rest.work.trainingViews, 0);
  for (const auto& [name, model] : rest.models) EXPECT_FALSE(model.oneFrame) << name;
}

/// A what-if of a long sequence is seen in the frame on screen before the contours of all others are made.
TEST(InspectOneFrame, SynthesisesOnlyTheContoursThatItNeeds) {
  const auto scene = litScene(sheet(0.3), 12);
  InspectionRequest q = oneFrameRequest();
  q.whatIf.synthesise = true;
  const auto made = [](const Inspection& in) {
    std::vector<int> frames;
    for (std::size_t i = 0; i < in.scene->frames.size(); ++i)
      if (!in.scene->frames[i].highlights.empty()) frames.push_back(int(i));
    return frames;
  };
  const Inspection all = inspect(scene, q);
  ASSERT_EQ(made(all).size(), 12u);
  const Inspection one = inspectOneFrame(scene, q, 9);
  EXPECT_EQ(made(one), (std::vector<int>{0, 1, 2, 3, 9}));
  expectSameFrame(one, all, 9);
  const Inspection other = inspectOneFrame(scene, q, 7, {}, &one);
  EXPECT_EQ(made(other), (std::vector<int>{0, 1, 2, 3, 7, 9}));
  expectSameFrame(other, all, 7);
  const Inspection again = inspectOneFrame(scene, q, 7, {}, &other);
  EXPECT_EQ(again.scene, other.scene);  // nothing new to make
  const Inspection rest = inspect(scene, q, {}, &other);
  EXPECT_EQ(made(rest).size(), 12u);
  EXPECT_EQ(digestOf(rest), digestOf(all));
  // Exposed for the frames that are known: another picture once all are.
  EXPECT_NE(pictureKey(one), pictureKey(all));
  EXPECT_EQ(pictureKey(rest), pictureKey(all));
  // Another lamp, beside a complete run: nothing of that run's contours is left.
  InspectionRequest moved = q;
  moved.whatIf.lightsBy[scene->lights.at(0).id] = {0.02, 0, 0};
  const Inspection follows = inspectOneFrame(scene, moved, 9, {}, &all);
  EXPECT_EQ(made(follows), (std::vector<int>{0, 1, 2, 3, 9}));
  expectSameFrame(follows, inspect(scene, moved), 9);
}

TEST(InspectOneFrame, KeepsWhatAnEarlierRunKnowsOfTheOthers) {
  const auto scene = exactScene(sheet(0.3), 12);
  const Inspection all = inspect(scene, oneFrameRequest());
  InspectionRequest fewer = oneFrameRequest();
  fewer.models = {"canonical"};
  const Inspection one = inspectOneFrame(scene, fewer, 9, {}, &all);
  EXPECT_EQ(one.work.framesDetected + one.work.predictions, 0);
  EXPECT_FALSE(one.models.at("canonical").oneFrame);
  EXPECT_EQ(one.models.at("canonical").frames.size(), 12u);

  InspectionRequest other = oneFrameRequest();
  other.settings.set("predict.level_set_step", 3.0);
  const Inspection changed = inspectOneFrame(scene, other, 9, {}, &all);
  EXPECT_EQ(changed.work.framesDetected + changed.work.fits, 0);
  EXPECT_TRUE(changed.models.at("limit-angle").oneFrame);
  EXPECT_EQ(digestOf(inspect(scene, other, {}, &changed)), digestOf(inspect(scene, other)));
}

TEST(InspectOneFrame, ALightThatOnlyOtherFramesShowIsNotLost) {
  // "right" is on in the last frame alone, which is held out and not the one that is looked at first.
  const auto scene = exactScene(sheet(0.2), {kOneFrameLeft, kOneFrameRight}, 8,
                                [](int i) { return std::vector<std::string>{i == 7 ? "right" : "left"}; });
  const Inspection all = inspect(scene, oneFrameRequest()), one = inspectOneFrame(scene, oneFrameRequest(), 5);
  EXPECT_EQ(all.models.at("limit-angle").fits.size(), 2u);
  EXPECT_EQ(one.models.at("limit-angle").fits.size(), 1u);
  expectSameFrame(one, all, 5);
  EXPECT_EQ(digestOf(inspect(scene, oneFrameRequest(), {}, &one)), digestOf(all));
}

TEST(InspectOneFrame, LightsThatOnlyAllFramesTellApartTakeAllFrames) {
  const auto scene = exactScene(sheet(0.3), {kOneFrameLeft, kOneFrameRight}, 8, [](int) {
    return std::vector<std::string>{"left", "right"};
  });
  for (Frame& f : scene->frames)
    for (Highlight& h : f.highlights) h.light.clear();
  const Inspection all = inspect(scene, oneFrameRequest()), one = inspectOneFrame(scene, oneFrameRequest(), 6);
  EXPECT_EQ(one.work.framesDetected, 8);
  expectSameFrame(one, all, 6);
  EXPECT_EQ(digestOf(inspect(scene, oneFrameRequest(), {}, &one)), digestOf(all));
}

TEST(InspectOneFrame, AHighlightMovedByHandIsMovedOnce) {
  const auto scene = exactScene(sheet(0.3), 8);
  InspectionRequest q = oneFrameRequest();
  q.whatIf.highlights[{6, 0}].contourBy = {3, -2};
  q.whatIf.highlights[{7, 0}].contourBy = {1, 1};
  const Inspection all = inspect(scene, q), one = inspectOneFrame(scene, q, 6);
  expectSameFrame(one, all, 6);
  EXPECT_EQ(digestOf(inspect(scene, q, {}, &one)), digestOf(all));
}

TEST(InspectOneFrame, RefusesAFrameThatDoesNotExist) {
  const auto scene = exactScene(sheet(0), 4);
  EXPECT_THROW(inspectOneFrame(scene, oneFrameRequest(), 4), std::invalid_argument);
  EXPECT_THROW(inspectOneFrame(scene, oneFrameRequest(), -1), std::invalid_argument);
}

}  // namespace
}  // namespace glint
