// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include "core/scene/capture.h"
#include "tests/core/scene/colmap_fixture.h"
#include "tests/tolerances.h"

namespace glint::colmap_write_tests {
namespace {
using namespace testing_support;
using testing::ElementsAre;
using testing::HasSubstr;
namespace fs = std::filesystem;

PosedImage colmapImage(const std::string& name) {
  PosedImage image;
  image.name = name;
  image.camera.width = 640;
  image.camera.height = 480;
  image.camera.pixelFromRay << 500, 0, 319.5, 0, 510, 239.5, 0, 0, 1;
  image.camera.camFromWorld.translation() << 0, 0, 5;
  return image;
}

/// The lines of a text that are no comments.
std::vector<std::string> colmapLines(const fs::path& file) {
  std::vector<std::string> lines;
  std::istringstream in(contentOf(file));
  for (std::string line; std::getline(in, line);)
    if (line.empty() || line.front() != '#') lines.push_back(line);
  return lines;
}

// Lines as the format's page defines them.
TEST(WriteColmapText, LinesOfEachFile) {
  const TemporaryFolder folder;
  PosedImage turned = colmapImage("b/2.jpg");
  turned.camera.camFromWorld.linear() << 1, 0, 0, 0, 0, -1, 0, 1, 0;  // a quarter about x
  turned.camera.camFromWorld.translation() << 10, 20, 30.25;
  writeColmapText({colmapImage("a.jpg"), turned}, folder / "model");
  EXPECT_THAT(colmapLines(folder / "model/cameras.txt"), ElementsAre("1 PINHOLE 640 480 500 510 320 240"));  // half a pixel more
  const std::vector<std::string> images = colmapLines(folder / "model/images.txt");
  ASSERT_EQ(images.size(), 4u);
  EXPECT_EQ(images[0], "1 1 0 0 0 0 0 5 1 a.jpg");
  EXPECT_EQ(images[1], "");  // no 2D points
  EXPECT_THAT(images[2],
              testing::MatchesRegex("2 0\\.7071067811865[0-9]+ 0\\.7071067811865[0-9]+ 0 0 10 20 30\\.25 1 b/2\\.jpg"));
  EXPECT_EQ(images[3], "");
  EXPECT_THAT(colmapLines(folder / "model/points3D.txt"), ElementsAre());
}

TEST(WriteColmapText, EqualCamerasBecomeOne) {
  const TemporaryFolder folder;
  PosedImage other = colmapImage("b.jpg"), same = colmapImage("c.jpg");
  other.camera.pixelFromRay(0, 0) = 501;
  writeColmapText({colmapImage("a.jpg"), other, same}, folder.path());
  EXPECT_THAT(colmapLines(folder / "cameras.txt"),
              ElementsAre("1 PINHOLE 640 480 500 510 320 240", "2 PINHOLE 640 480 501 510 320 240"));
  EXPECT_EQ(colmapLines(folder / "images.txt").at(4), "3 1 0 0 0 0 0 5 1 c.jpg");
}

// Ours that COLMAP has under another name, for its models have no k3 or one focal length: the line, and the same pixels.
struct WrittenColmapLens {
  const char* name;
  Lens lens;
  double fy;
  const char* line;
};
class WriteColmapLens : public testing::TestWithParam<WrittenColmapLens> {};
INSTANTIATE_TEST_SUITE_P(
    Every, WriteColmapLens,
    testing::Values(
        WrittenColmapLens{
            "OpenCv", {LensModel::OpenCv, {.5, .25, .125, 2}}, 510, "OPENCV 640 480 500 510 320 240 0.5 0.25 0.125 2"},
        WrittenColmapLens{"OpenCvWithK3",
                          {LensModel::OpenCv, {.5, .25, .125, 2, 4}},
                          510,
                          "FULL_OPENCV 640 480 500 510 320 240 0.5 0.25 0.125 2 4 0 0 0"},
        WrittenColmapLens{"FullOpenCv",
                          {LensModel::FullOpenCv, {.5, .25, .125, 2, 4, 8, 16, 32}},
                          510,
                          "FULL_OPENCV 640 480 500 510 320 240 0.5 0.25 0.125 2 4 8 16 32"},
        WrittenColmapLens{"SimpleRadial", {LensModel::SimpleRadial, {.5}}, 500, "SIMPLE_RADIAL 640 480 500 320 240 0.5"},
        WrittenColmapLens{"SimpleRadialOfTwo", {LensModel::SimpleRadial, {.5}}, 510, "OPENCV 640 480 500 510 320 240 0.5 0 0 0"},
        WrittenColmapLens{"Radial", {LensModel::Radial, {.5, .25}}, 500, "RADIAL 640 480 500 320 240 0.5 0.25"},
        WrittenColmapLens{"RadialOfTwo", {LensModel::Radial, {.5, .25}}, 510, "OPENCV 640 480 500 510 320 240 0.5 0.25 0 0"},
        WrittenColmapLens{"OpenCvFisheye",
                          {LensModel::OpenCvFisheye, {.5, .25, .125, 2}},
                          510,
                          "OPENCV_FISHEYE 640 480 500 510 320 240 0.5 0.25 0.125 2"},
        WrittenColmapLens{
            "SimpleRadialFisheye", {LensModel::SimpleRadialFisheye, {.5}}, 500, "SIMPLE_RADIAL_FISHEYE 640 480 500 320 240 0.5"},
        WrittenColmapLens{"SimpleRadialFisheyeOfTwo",
                          {LensModel::SimpleRadialFisheye, {.5}},
                          510,
                          "OPENCV_FISHEYE 640 480 500 510 320 240 0.5 0 0 0"},
        WrittenColmapLens{
            "RadialFisheye", {LensModel::RadialFisheye, {.5, .25}}, 500, "RADIAL_FISHEYE 640 480 500 320 240 0.5 0.25"},
        WrittenColmapLens{"RadialFisheyeOfTwo",
                          {LensModel::RadialFisheye, {.5, .25}},
                          510,
                          "OPENCV_FISHEYE 640 480 500 510 320 240 0.5 0.25 0 0"},
        WrittenColmapLens{"Fov", {LensModel::Fov, {.5}}, 510, "FOV 640 480 500 510 320 240 0.5"},
        WrittenColmapLens{"ThinPrismFisheye",
                          {LensModel::ThinPrismFisheye, {.5, .25, .125, 2, 4, 8, 16, 32}},
                          510,
                          "THIN_PRISM_FISHEYE 640 480 500 510 320 240 0.5 0.25 0.125 2 4 8 16 32"}),
    [](const auto& info) { return std::string(info.param.name); });

TEST_P(WriteColmapLens, IsOneOfColmaps) {
  const TemporaryFolder folder;
  PosedImage image = colmapImage("a.jpg");
  image.camera.lens = GetParam().lens;
  image.camera.pixelFromRay(1, 1) = GetParam().fy;
  writeColmapText({image}, folder.path());
  EXPECT_THAT(colmapLines(folder / "cameras.txt"), ElementsAre(std::string("1 ") + GetParam().line));
  const Camera read = readColmap(folder.path()).views.at(0).camera;
  EXPECT_EQ(read.pixelFromRay, image.camera.pixelFromRay);
  for (const Pixel& p : {Pixel(319.5, 239.5), Pixel(350, 200), Pixel(200, 290)})
    EXPECT_LT((read.distorted(p) - image.camera.distorted(p)).norm(), 1e-10);  // round-off of pixels of order 1e3
}

TEST(WriteColmapText, ReadsBackAsItWas) {
  const TemporaryFolder folder;
  PosedImage image = colmapImage("a/b.jpg");
  const Eigen::Quaterniond turn = Eigen::Quaterniond(0.1, -0.7, 0.3, 0.5).normalized();
  image.camera.camFromWorld.linear() = turn.toRotationMatrix();
  image.camera.camFromWorld.translation() << 0.1, -1e-9 / 3, 1e6 / 3;
  image.camera.pixelFromRay << 500.1 / 3, 0, 319.7, 0, 510.1 / 3, 239.9, 0, 0, 1;
  writeColmapText({image}, folder.path());
  const CaptureView view = readColmap(folder.path()).views.at(0);
  EXPECT_EQ(view.name, "a/b.jpg");
  EXPECT_EQ(view.camera.camFromWorld.translation(), image.camera.camFromWorld.translation());
  EXPECT_LT((view.camera.camFromWorld.linear() - turn.toRotationMatrix()).norm(), tolerance::kExact);
  EXPECT_LT((view.camera.pixelFromRay - image.camera.pixelFromRay).norm(), tolerance::kExact * 1e3);  // cx of order 1e3
}

TEST(WriteColmapText, RefusesWhatColmapDoesNotHave) {
  const TemporaryFolder folder;
  const auto errorOf = [&](const PosedImage& image) {
    return inputErrorOf([&] { writeColmapText({colmapImage("first.jpg"), image}, folder / "model"); });
  };
  PosedImage skewed = colmapImage("b.jpg"), visual = colmapImage("c.jpg");
  skewed.camera.pixelFromRay(0, 1) = 0.25;
  visual.camera.lens = {LensModel::VisualSfm, {.5}};
  const std::string where = (folder / "model").string();
  EXPECT_EQ(errorOf(skewed), where + ": b.jpg: COLMAP has no camera with skew (0.25 px)");
  EXPECT_EQ(errorOf(visual), where + ": c.jpg: COLMAP has no lens as VISUALSFM's");
  EXPECT_THAT(errorOf(colmapImage("first.jpg")), HasSubstr("two images have this name"));
  EXPECT_THAT(errorOf(colmapImage("a\nb")), HasSubstr("image 2: the name of the image"));
  EXPECT_THAT(errorOf(colmapImage("photo 1.jpg")), HasSubstr("photo 1.jpg: COLMAP ends the name of an image at its first blank"));
  EXPECT_THAT(errorOf(colmapImage("")), HasSubstr("image 2: the name of the image is missing"));
  EXPECT_FALSE(fs::exists(folder / "model"));
}

// Readers prefer a binary model, and compare rigs with images.
TEST(WriteColmapText, RefusesAFolderWhoseOtherFilesWouldBeRead) {
  for (const char* file : {"cameras.bin", "images.bin", "rigs.txt"}) {
    const TemporaryFolder folder;
    folder.write(file, "x");
    EXPECT_THAT(inputErrorOf([&] { writeColmapText({colmapImage("a.jpg")}, folder.path()); }),
                HasSubstr(std::string("contains ") + file + " of another model"));
    EXPECT_FALSE(fs::exists(folder / "cameras.txt"));
  }
  const TemporaryFolder folder;
  writeColmap(folder);
  folder.write("mesh.ply", "kept");
  writeColmapText({colmapImage("a.jpg")}, folder.path());  // over an older text
  EXPECT_EQ(readColmap(folder.path()).views.size(), 1u);
  EXPECT_EQ(contentOf(folder / "mesh.ply"), "kept");
}

}  // namespace
}  // namespace glint::colmap_write_tests
