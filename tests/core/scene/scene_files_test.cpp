// SPDX-License-Identifier: BSD-3-Clause
#include "core/scene/scene_files.h"

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

TEST(FrameFileProblems, NamesFileAndReasonOfEveryFrameThatHasNone) {
  const TemporaryFolder folder;
  const Scene scene = sceneOf(folder.path(), {"good.png", "gone.png", "empty.png", "cut.png", "small.png", "", "known.png"});
  picture(folder / "good.png", 40, 30);
  folder.write("empty.png", "");
  folder.write("cut.png", contentOf(folder / "good.png").substr(0, 60));
  picture(folder / "small.png", 20, 30);
  const FrameFileProblems problems = frameFileProblems(scene, {{FrameFile::Photograph, {{6, "told already"}}}});
  ASSERT_EQ(problems.size(), 1u);
  const std::map<int, std::string>& found = problems.at(FrameFile::Photograph);
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
  EXPECT_THROW((void)frameFileProblems(scene, {}, [](const StageEvent&) { return false; }), Stopped);
}

TEST(FrameFileProblems, KnowsWhichKindOfFileIsMissing) {
  const TemporaryFolder folder;
  Scene scene = sceneOf(folder.path(), {"a.png", "b.png"});
  for (Frame& f : scene.frames) picture(f.image, 40, 30);
  scene.frames[0].depth = folder / "depth/a.tiff";
  scene.frames[0].normals = folder.write("normals/a.png", "");
  scene.frames[1].mask = folder / "masks/b.png";
  picture(scene.frames[1].mask, 40, 40);
  const FrameFileProblems found = frameFileProblems(scene);
  ASSERT_EQ(found.size(), 3u);
  EXPECT_THAT(found.at(FrameFile::Depth), testing::ElementsAre(testing::Pair(0, HasSubstr("depth/a.tiff: "))));
  EXPECT_THAT(found.at(FrameFile::Normals),
              testing::ElementsAre(testing::Pair(0, HasSubstr("normals/a.png: the file is empty"))));
  EXPECT_THAT(found.at(FrameFile::Mask), testing::ElementsAre(testing::Pair(1, HasSubstr("40 x 40 pixels"))));
  EXPECT_TRUE(frameFileProblems(scene, found).empty());
  scene.frames[0].radiance = folder / "radiance/a.tiff";  // beside an image that is there
  EXPECT_THAT(frameFileProblem(scene.frames[0], FrameFile::Photograph), HasSubstr("radiance/a.tiff: "));
  for (const auto& [kind, lines] : found)
    for (const auto& [frame, line] : lines) EXPECT_EQ(fileNamedIn(line, scene.frames[std::size_t(frame)]), kind);
  EXPECT_EQ(fileNamedIn(readMask(scene.frames[1]).failure().detail, scene.frames[1]), FrameFile::Mask);
  EXPECT_EQ(fileNamedIn(readDepth(scene.frames[0]).failure().detail, scene.frames[0]), FrameFile::Depth);
  EXPECT_EQ(fileNamedIn("frame a.png has no image, radiance or highlights", scene.frames[0]), std::nullopt);
}

TEST(WithMeshAt, EverySurfaceOfTheMeshHasTheOther) {
  const TemporaryFolder folder;
  for (const char* name : {"a.ply", "b.ply"}) folder.write(name, "x");
  const std::string text = with(with(minimalScene(), R"({"ball": {"analytic": {"type": "sphere", "radius": 0.4}}})",
                                     R"({"ball": {"mesh": "./a.ply"}, "a2": {"mesh": "./a.ply"}, "b": {"mesh": "b.ply"}})"),
                                R"({"id": "a", )", R"({"id": "a", "surface": "b", )");
  const Scene scene = readScene(folder.write("scene.json", text));
  EXPECT_EQ(meshNamedIn((folder / "a.ply").string() + ": vertices: is cut off", scene), "./a.ply");
  EXPECT_EQ(meshNamedIn((folder / "c.ply").string() + ": is cut off", scene), "");
  const Scene moved = withMeshAt(scene, "./a.ply", "/elsewhere/c.ply");
  EXPECT_EQ(moved.surfaces.at("ball").file()->file, "/elsewhere/c.ply");
  EXPECT_EQ(moved.surfaces.at("a2").file()->file, "/elsewhere/c.ply");
  EXPECT_EQ(moved.surfaces.at("b").file()->file, folder / "b.ply");
  EXPECT_THAT(moved.meshes, testing::ElementsAre(testing::Pair("./a.ply", "/elsewhere/c.ply")));
}

TEST(WithFilesIn, FindsTheLongestEndOfThePathAndLeavesTheRest) {
  const TemporaryFolder there, other;
  Scene scene = sceneOf(there.path(), {"a/0.png", "b/0.png", "b/1.png", "b/2.png"});
  scene.frames[0].depth = there / "depth/0.png";
  picture(other / "b/0.png", 40, 30);
  picture(other / "0.png", 40, 30);
  picture(other / "1.png", 40, 30);
  int found = 0;
  const Scene moved = withFilesIn(scene, FrameFile::Photograph, other.path(), &found);
  EXPECT_EQ(found, 3);
  EXPECT_EQ(moved.frames[0].image, other / "0.png");
  EXPECT_EQ(moved.frames[1].image, other / "b/0.png") << "the longer end wins over 0.png";
  EXPECT_EQ(moved.frames[2].image, other / "1.png");
  EXPECT_EQ(moved.frames[3].image, there / "b/2.png") << "not there: stays";
  EXPECT_EQ(moved.frames[0].depth, there / "depth/0.png") << "0.png is a photograph, no depth map";
}

TEST(WithFilesIn, OneFileIsNotTwoPictures) {
  const TemporaryFolder there, other;
  Scene scene = sceneOf(there.path(), {"frames/0.tiff"});
  scene.frames[0].radiance = there / "radiance/0.tiff";
  picture(other / "0.tiff", 40, 30);
  const Scene moved = withFilesIn(scene, FrameFile::Photograph, other.path());
  EXPECT_EQ(moved.frames[0].image, other / "0.tiff");
  EXPECT_EQ(moved.frames[0].radiance, there / "radiance/0.tiff");
}

TEST(WithFilesIn, FindsEachKindByItselfAndRemembersTheFolders) {
  const TemporaryFolder there, other, third;
  Scene scene = sceneOf(there.path(), {"frames/0.png", "frames/1.png"});
  for (std::size_t i = 0; i < 2; ++i) scene.frames[i].mask = there / ("masks/" + std::to_string(i) + ".png");
  for (const char* name : {"frames/0.png", "masks/0.png", "masks/1.png"}) picture(other / name, 40, 30);
  picture(third / "1.png", 40, 30);
  int found = 0;
  Scene moved = withFilesIn(scene, FrameFile::Mask, other.path(), &found);
  EXPECT_EQ(found, 2);
  EXPECT_EQ(moved.frames[0].mask, other / "masks/0.png");
  EXPECT_EQ(moved.frames[0].image, there / "frames/0.png") << "only the masks are looked for";
  moved = withFilesIn(moved, FrameFile::Depth, other.path(), &found);
  EXPECT_EQ(found, 0) << "no frame has a depth map";
  moved = withFilesIn(moved, FrameFile::Photograph, other.path());
  moved = withFilesIn(moved, FrameFile::Photograph, third.path());
  EXPECT_EQ(moved.frames[0].image, other / "frames/0.png") << "not in the folder that was given last: stays";
  EXPECT_EQ(moved.frames[1].image, third / "1.png");
  const std::vector<FilesFolder> folders{
      {FrameFile::Mask, other.path()}, {FrameFile::Photograph, other.path()}, {FrameFile::Photograph, third.path()}};
  EXPECT_EQ(moved.folders, folders);
  const Scene again = withFilesIn(scene, folders);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(again.frames[i].image, moved.frames[i].image);
    EXPECT_EQ(again.frames[i].mask, moved.frames[i].mask);
  }
  // What is given again counts again, and stands once.
  moved = withFilesIn(moved, FrameFile::Photograph, other.path());
  EXPECT_EQ(moved.folders, (std::vector{folders[0], folders[2], folders[1]}));
}

TEST(WithFilesIn, AFileThatTheFrameUsesForSomethingElseIsNotTaken) {
  const TemporaryFolder there, other;
  Scene scene = sceneOf(there.path(), {"frames/0.png"});
  scene.frames[0].mask = there / "masks/0.png";
  picture(there / "frames/0.png", 40, 30);
  picture(other / "0.png", 40, 30);
  int found = 0;
  EXPECT_EQ(withFilesIn(scene, FrameFile::Mask, there / "frames", &found).frames[0].mask, there / "masks/0.png");
  EXPECT_EQ(found, 0) << "it is the photograph";
  // Where either could be meant, nobody can tell.
  using Kinds = std::set<FrameFile>;
  EXPECT_EQ(ambiguousIn(scene, {FrameFile::Photograph, FrameFile::Mask}, other.path()),
            (Kinds{FrameFile::Photograph, FrameFile::Mask}));
  EXPECT_EQ(ambiguousIn(scene, {FrameFile::Mask}, other.path()), Kinds());
  picture(other / "masks/0.png", 40, 30);
  EXPECT_EQ(ambiguousIn(scene, {FrameFile::Photograph, FrameFile::Mask}, other.path()), Kinds()) << "each has its own";
}

}  // namespace
}  // namespace glint
