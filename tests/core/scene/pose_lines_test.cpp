// SPDX-License-Identifier: BSD-3-Clause
#include "core/scene/pose_lines.h"

#include <gmock/gmock.h>

#include <cmath>
#include <sstream>

#include "tests/core/scene/scene_fixture.h"
#include "tests/tolerances.h"

namespace glint::pose_lines_tests {
namespace {
using namespace testing_support;
using testing::AllOf;
using testing::HasSubstr;

/// A camera at (1, 2, 3), turned by 90 degrees about the world's z: R of world to camera has the rows y, -x, z, and t = -R c.
constexpr const char* kTurnedJson =
    R"({"id": "0007", "time": 1.25, "camera_from_world": [[0,1,0,-2],[-1,0,0,1],[0,0,1,-3],[0,0,0,1]]})";
constexpr const char* kTurnedTum = "1.25 1 2 3 0 0 0.70710678118654752 0.70710678118654752";

Eigen::Matrix4d turned() {
  Eigen::Matrix4d m;
  m << 0, 1, 0, -2, -1, 0, 0, 1, 0, 0, 1, -3, 0, 0, 0, 1;
  return m;
}

std::optional<PoseLine> firstOf(const std::string& text) {
  std::istringstream in(text);
  return PoseLineReader(in, "poses").next();
}

std::string refusalOf(const std::string& text) {
  return inputErrorOf([&] { firstOf(text); });
}

TEST(PoseLines, BothFormsSayTheSamePose) {
  const auto json = firstOf(kTurnedJson), tum = firstOf(kTurnedTum);
  ASSERT_TRUE(json && tum);
  EXPECT_EQ(json->id, "0007");
  EXPECT_EQ(tum->id, "1.25");  // TUM's lines have no name but their time
  EXPECT_EQ(json->time, 1.25);
  EXPECT_EQ(tum->time, 1.25);
  EXPECT_LT((json->cameraFromWorld.matrix() - turned()).cwiseAbs().maxCoeff(), tolerance::kExact);
  EXPECT_LT((tum->cameraFromWorld.matrix() - turned()).cwiseAbs().maxCoeff(), tolerance::kExact);
  EXPECT_FALSE(json->camera || tum->camera);
}

TEST(PoseLines, ACameraOfTheLineTakesItsPose) {
  const auto line =
      firstOf(R"({"id": "a", "camera_from_world": [[0,1,0,-2],[-1,0,0,1],[0,0,1,-3],[0,0,0,1]],)"
              R"( "camera": {"width": 64, "height": 48, "fx": 70, "fy": 71, "cx": 31, "cy": 23, "distortion": [0.1,0,0,0]}})");
  ASSERT_TRUE(line && line->camera);
  EXPECT_EQ(line->time, std::nullopt);
  EXPECT_EQ(line->camera->pixelFromRay(1, 1), 71);
  EXPECT_EQ(line->camera->lens.parameters[0], 0.1);
  EXPECT_EQ(line->camera->camFromWorld.matrix(), line->cameraFromWorld.matrix());
}

TEST(PoseLines, LengthsOfEverySizeAreKept) {
  for (const double scale : {1e-9, 1e-3, 1e3, 1e9}) {
    std::ostringstream tum;
    tum.precision(17);
    tum << "0 " << scale << ' ' << 2 * scale << ' ' << 3 * scale << " 0 0 0.70710678118654752 0.70710678118654752";
    const auto line = firstOf(tum.str());
    ASSERT_TRUE(line) << scale;
    EXPECT_LT((line->cameraFromWorld.translation() / scale - Eigen::Vector3d(-2, 1, -3)).norm(), tolerance::kExact) << scale;
  }
}

TEST(PoseLines, ARotationOfFewDigitsIsRepairedAndSaid) {
  const std::string rounded =  // 30 degrees about z, four digits
      R"({"id": "a", "camera_from_world": [[0.8660,-0.5,0,0],[0.5,0.8660,0,0],[0,0,1,0],[0,0,0,1]]})";
  std::istringstream in(rounded + "\n" + "0 0 0 0 0 0 0 1.1\n" + kTurnedTum + "\n");
  PoseLineReader reader(in, "poses");
  const auto line = reader.next();
  ASSERT_TRUE(line);
  const Eigen::Matrix3d r = line->cameraFromWorld.linear();
  EXPECT_LT((r * r.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff(), tolerance::kExact);
  EXPECT_NEAR(std::atan2(r(1, 0), r(0, 0)) * 180 / M_PI, 30, 2e-3);  // 5e-5 of 0.866 and 0.5
  EXPECT_THAT(reader.warning(), AllOf(HasSubstr("line 1: camera_from_world"), HasSubstr("nearest")));
  ASSERT_TRUE(reader.next());
  EXPECT_THAT(reader.warning(), AllOf(HasSubstr("line 2"), HasSubstr("length 1.1")));
  ASSERT_TRUE(reader.next());
  EXPECT_EQ(reader.warning(), "");
}

TEST(PoseLines, WhatIsNoPoseIsRefusedWithItsPlace) {
  const std::string eye = "[[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]";
  const struct {
    const char* name;
    std::string line, place, reason;
  } cases[] = {
      {"syntax", R"({"id": "a", })", "poses: line 1: column", "not valid JSON"},
      {"no name", R"({"camera_from_world": )" + eye + "}", "poses: line 1", "needs an id or a time"},
      {"no pose", R"({"id": "a"})", "poses: line 1: camera_from_world", "is missing"},
      {"mirrored", R"({"id": "a", "camera_from_world": [[-1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]})",
       "poses: line 1: camera_from_world", "mirrored"},
      {"scaled", R"({"id": "a", "camera_from_world": [[2,0,0,0],[0,2,0,0],[0,0,2,0],[0,0,0,1]]})",
       "poses: line 1: camera_from_world", "not a rotation"},
      {"NaN inside", R"({"id": "a", "camera_from_world": [[1,0,0,NaN],[0,1,0,0],[0,0,1,0],[0,0,0,1]]})",
       "poses: line 1: camera_from_world", "there is no finite pose"},
      {"far away", R"({"id": "a", "camera_from_world": [[1,0,0,1e300],[0,1,0,0],[0,0,1,0],[0,0,0,1]]})",
       "poses: line 1: camera_from_world[0][3]", "larger than 1e15"},
      {"the other way round", R"({"id": "a", "camera_from_world": )" + eye + R"(, "world_from_camera": )" + eye + "}",
       "poses: line 1: world_from_camera", "geometry"},
      {"control character", R"({"id": "a\u0007", "camera_from_world": )" + eye + "}", "poses: line 1: id", "control"},
      {"camera without focal length",
       R"({"id": "a", "camera_from_world": )" + eye +
           R"(, "camera": {"width": 4, "height": 4, "fx": 0, "fy": 1, "cx": 0, "cy": 0}})",
       "poses: line 1: camera.fx", "positive"},
      {"deep", "{\"id\": " + std::string(5000, '[') + std::string(5000, ']') + "}", "poses: line 1", "nested deeper"},
      {"seven numbers", "1 2 3 4 0 0 0", "poses: line 1", "has 7 words"},
      {"nine numbers", "1 2 3 4 0 0 0 1 1", "poses: line 1", "more than 8 words"},
      {"no rotation", "1 2 3 4 0 0 0 0", "poses: line 1", "there is no finite pose"},
      {"nothing but zeros", R"({"id": "a", "camera_from_world": [[0,0,0,0],[0,0,0,0],[0,0,0,0],[0,0,0,0]]})",
       "poses: line 1: camera_from_world", "there is no finite pose"},
      {"a word", "1 2 x 4 0 0 0 1", "poses: line 1", "number"},
      {"time without end", "inf 2 3 4 0 0 0 1", "poses: line 1", "number"},
      {"a list", "[1, 2]", "poses: line 1", "has 2 words"},
  };
  for (const auto& c : cases) EXPECT_THAT(refusalOf(c.line), AllOf(HasSubstr(c.place), HasSubstr(c.reason))) << c.name;
}

/// As a full disk or a killed program leaves the last one.
TEST(PoseLines, ALineThatIsCutCostsItsPose) {
  const TemporaryFolder folder;
  const std::string whole = R"({"id": "a", "camera_from_world": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 2], [0, 0, 0, 1]]})";
  for (const std::string& cut :
       {std::string(R"({"id": "b", "camera_from_world": [[1, 0, 0, 0], [0, 1)"),
        std::string(R"({"id": "b", "camera_from_world": [[1, 0, 0, 0], [0, 1, 0]]})"), std::string("1.5 2 3 4")}) {
    folder.write("poses.txt", whole + "\n" + cut);
    std::vector<std::string> warnings;
    EXPECT_EQ(readPoseLines(folder / "poses.txt", warnings).size(), 1u) << cut;
    EXPECT_THAT(warnings, testing::Contains(HasSubstr("poses.txt: line 2: has fewer numbers than a pose"))) << cut;
    folder.write("poses.txt", cut);
    EXPECT_THROW(readPoseLines(folder / "poses.txt", warnings), CutPose) << cut;
  }
}

TEST(PoseLines, ReadingGoesOnBehindAWrongLine) {
  std::istringstream in("# comment\n\n" + std::string(kLongestPoseLine + 1, 'x') + "\n" +
                        R"({"id": "0002", "camera_from_world": 5})" + "\n1 nan nan nan nan nan nan nan\n" +
                        R"({"id": "0003", "camera_from_world": null})" + "\r\n" + kTurnedJson);
  PoseLineReader reader(in, "poses");
  EXPECT_THAT(inputErrorOf([&] { reader.next(); }), AllOf(HasSubstr("line 3"), HasSubstr("longer than 65536")));
  EXPECT_EQ(reader.id(), "");
  EXPECT_THAT(inputErrorOf([&] { reader.next(); }), HasSubstr("line 4: camera_from_world"));
  EXPECT_EQ(reader.id(), "0002");  // known, although the pose is not
  EXPECT_THROW(reader.next(), LostPose);
  EXPECT_EQ(reader.id(), "1");
  EXPECT_THROW(reader.next(), LostPose);
  EXPECT_EQ(reader.id(), "0003");
  const auto last = reader.next();  // has no line break
  ASSERT_TRUE(last);
  EXPECT_EQ(last->id, "0007");
  EXPECT_EQ(reader.line(), 7u);
  EXPECT_FALSE(reader.next());
  EXPECT_FALSE(reader.next());
}

TEST(PoseLines, AFileIsReadAsAWhole) {
  const TemporaryFolder folder;
  std::vector<std::string> warnings;
  folder.write("a.txt", std::string("\xEF\xBB\xBF") + kTurnedTum + "\n2 nan 0 0 0 0 0 1\n3 0 0 0 0 0 0 1\n4 1 2 3 0 0 0 0\n");
  const std::vector<PoseLine> poses = readPoseLines(folder / "a.txt", warnings);
  ASSERT_EQ(poses.size(), 2u);
  EXPECT_EQ(poses[1].id, "3");
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_THAT(warnings[0], HasSubstr("a.txt: line 2 and 1 more: no finite pose (tracking was lost); they are left out"));
  folder.write("again.txt", "1 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 1\n");
  EXPECT_EQ(readPoseLines(folder / "again.txt", warnings).size(), 1u);
  EXPECT_THAT(warnings.back(), HasSubstr("again.txt: line 2: says the same as a line before"));
  folder.write("twice.txt", "1 0 0 0 0 0 0 1\n1 0 0 2 0 0 0 1\n");
  EXPECT_THAT(inputErrorOf([&] { readPoseLines(folder / "twice.txt", warnings); }),
              AllOf(HasSubstr("twice.txt: line 2"), HasSubstr("duplicate id")));
  folder.write("none.txt", "# nothing\n");
  EXPECT_THAT(inputErrorOf([&] { readPoseLines(folder / "none.txt", warnings); }), HasSubstr("has no pose"));
  folder.write("lost.txt", "1 nan 0 0 0 0 0 1\n");
  EXPECT_THAT(inputErrorOf([&] { readPoseLines(folder / "lost.txt", warnings); }), HasSubstr("no finite pose"));
}

}  // namespace
}  // namespace glint::pose_lines_tests
