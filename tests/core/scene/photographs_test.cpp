// SPDX-License-Identifier: BSD-3-Clause
#include "core/scene/photographs.h"

#include <gmock/gmock.h>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "tests/core/scene/scene_fixture.h"

namespace glint {
namespace {
using namespace testing_support;
using testing::HasSubstr;
namespace fs = std::filesystem;

void picture(const fs::path& file, int width, int height) {
  fs::create_directories(file.parent_path());
  ASSERT_TRUE(cv::imwrite(file.string(), cv::Mat(height, width, CV_8UC3, cv::Scalar(10, 20, 30))));
}

Scene sceneOf(const fs::path& folder, const std::vector<std::string>& images) {
  Scene scene;
  scene.folder = folder;
  for (const std::string& image : images) {
    Frame f;
    f.id = image;
    if (!image.empty()) f.image = folder / image;
    f.camera.width = 40;
    f.camera.height = 30;
    scene.frames.push_back(f);
  }
  return scene;
}

TEST(PhotographProblems, NamesFileAndReasonOfEveryFrameThatHasNone) {
  const TemporaryFolder folder;
  const Scene scene = sceneOf(folder.path(), {"good.png", "gone.png", "empty.png", "cut.png", "small.png", "", "known.png"});
  picture(folder / "good.png", 40, 30);
  folder.write("empty.png", "");
  folder.write("cut.png", contentOf(folder / "good.png").substr(0, 60));
  picture(folder / "small.png", 20, 30);
  const std::map<int, std::string> found = photographProblems(scene, {{6, "told already"}});
  ASSERT_EQ(found.size(), 4u);
  EXPECT_THAT(found.at(1), HasSubstr("gone.png"));
  EXPECT_THAT(found.at(2), HasSubstr("empty"));
  EXPECT_THAT(found.at(3), HasSubstr("truncated"));
  EXPECT_THAT(found.at(4), HasSubstr("20 x 30 pixels, the camera 40 x 30"));
  for (const auto& [frame, line] : found) {
    EXPECT_EQ(line.find('\n'), std::string::npos);
    EXPECT_THAT(withoutFolder(line, scene), testing::StartsWith(scene.frames[std::size_t(frame)].id));
    // What cannot be decoded is found without decoding.
    EXPECT_FALSE(readPhotograph(scene.frames[std::size_t(frame)]));
  }
  EXPECT_THROW((void)photographProblems(scene, {}, [](const StageEvent&) { return false; }), Stopped);
}

TEST(WithPhotographsIn, FindsTheLongestEndOfThePathAndLeavesTheRest) {
  const TemporaryFolder there, other;
  Scene scene = sceneOf(there.path(), {"a/0.png", "b/0.png", "b/1.png", "b/2.png"});
  scene.frames[0].depth = there / "depth/0.png";
  picture(other / "b/0.png", 40, 30);
  picture(other / "0.png", 40, 30);
  picture(other / "1.png", 40, 30);
  int found = 0;
  const Scene moved = withPhotographsIn(scene, other.path(), &found);
  EXPECT_EQ(found, 3);
  EXPECT_EQ(moved.frames[0].image, other / "0.png");
  EXPECT_EQ(moved.frames[1].image, other / "b/0.png") << "the longer end wins over 0.png";
  EXPECT_EQ(moved.frames[2].image, other / "1.png");
  EXPECT_EQ(moved.frames[3].image, there / "b/2.png") << "not there: stays";
  EXPECT_EQ(moved.frames[0].depth, there / "depth/0.png") << "0.png is a photograph, no depth map";
}

TEST(WithPhotographsIn, OneFileIsNotTwoPictures) {
  const TemporaryFolder there, other;
  Scene scene = sceneOf(there.path(), {"frames/0.tiff"});
  scene.frames[0].radiance = there / "radiance/0.tiff";
  picture(other / "0.tiff", 40, 30);
  const Scene moved = withPhotographsIn(scene, other.path());
  EXPECT_EQ(moved.frames[0].image, other / "0.tiff");
  EXPECT_EQ(moved.frames[0].radiance, there / "radiance/0.tiff");
}

}  // namespace
}  // namespace glint
