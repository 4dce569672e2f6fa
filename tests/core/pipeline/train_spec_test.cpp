// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "core/pipeline/inspection.h"
#include "core/scene/frame_name.h"
#include "tests/core/scene/scene_fixture.h"

namespace glint {
namespace {

using testing_support::inputErrorOf;

Scene sceneOf(const std::vector<std::string>& ids) {
  Scene scene;
  for (const std::string& id : ids) {
    scene.frames.emplace_back();
    scene.frames.back().id = id;
  }
  return scene;
}

Scene numbered(int n) {
  std::vector<std::string> ids;
  for (int i = 0; i < n; ++i) ids.push_back("f" + std::to_string(i));
  return sceneOf(ids);
}

using Frames = std::vector<int>;

TEST(TrainSpec, SpreadTakesFrameFloorOfINOverK) {
  EXPECT_EQ(parseTrainSpec("spread:6", numbered(80)).frames, (Frames{0, 13, 26, 40, 53, 66}));
  EXPECT_EQ(parseTrainSpec("spread:6", numbered(6)).frames, (Frames{0, 1, 2, 3, 4, 5}));
  EXPECT_EQ(parseTrainSpec("spread:1", numbered(9)).frames, (Frames{0}));
  for (int n = 1; n < 40; ++n)
    for (int k = 1; k <= n; ++k) {
      const Frames frames = parseTrainSpec("spread:" + std::to_string(k), numbered(n)).frames;
      ASSERT_EQ(frames.size(), std::size_t(k));
      for (int i = 0; i < k; ++i) EXPECT_EQ(frames[std::size_t(i)], i * n / k);
    }
}

TEST(TrainSpec, FirstRangesIdsAndNumbers) {
  const Scene scene = numbered(20);
  EXPECT_EQ(parseTrainSpec("first:3", scene).frames, (Frames{0, 1, 2}));
  EXPECT_EQ(parseTrainSpec("0-5", scene).frames, (Frames{0, 1, 2, 3, 4, 5}));
  EXPECT_EQ(parseTrainSpec("14,0,7,0", scene).frames, (Frames{0, 7, 14}));
  EXPECT_EQ(parseTrainSpec("f3-f5,19,4-6", scene).frames, (Frames{3, 4, 5, 6, 19}));
  EXPECT_FALSE(parseTrainSpec("0-5", scene).perSurface);
}

TEST(TrainSpec, IdsWinOverNumbersAndMayHoldSeparators) {
  EXPECT_EQ(parseTrainSpec("2", sceneOf({"2", "1", "0"})).frames, (Frames{0}));
  EXPECT_EQ(parseTrainSpec("cam-1", sceneOf({"cam-0", "cam-1"})).frames, (Frames{1}));
  EXPECT_EQ(parseTrainSpec("cam-0-cam-2", sceneOf({"cam-0", "cam-1", "cam-2"})).frames, (Frames{0, 1, 2}));
  EXPECT_EQ(parseTrainSpec("left:1", sceneOf({"left:0", "left:1"})).frames, (Frames{1}));
}

TEST(TrainSpec, PerSurfaceTrainsOnEveryFrame) {
  const TrainSpec spec = parseTrainSpec("per-surface", numbered(4));
  EXPECT_TRUE(spec.perSurface);
  EXPECT_EQ(spec.frames, (Frames{0, 1, 2, 3}));
}

TEST(TrainSpec, WrongSpecificationsNameTheFlagAndTheReason) {
  const Scene scene = numbered(6);
  for (const char* text : {"",         ",",       "0,,1",     "0,",       "first",  "first:",   "first:0",
                           "first:-1", "first:7", "spread:7", "spread:x", "last:3", "6",        "-1",
                           "0-6",      "3-1",     "0-",       "nobody",   "1.5",    "first:3x", "99999999999999999999"}) {
    const std::string message = inputErrorOf([&, text] { (void)parseTrainSpec(text, scene); });
    EXPECT_NE(message.find("--train"), std::string::npos) << text << ": " << message;
  }
  EXPECT_NE(inputErrorOf([&] { (void)parseFrames("9", scene, "--frames"); }).find("--frames 9"), std::string::npos);
}

}  // namespace
}  // namespace glint
