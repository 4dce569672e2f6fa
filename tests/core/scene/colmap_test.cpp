// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <sstream>

#include "tests/core/scene/colmap_fixture.h"
#include "tests/shared_data.h"
#include "tests/tolerances.h"

namespace glint::colmap_tests {
namespace {
using namespace testing_support;
using Eigen::Vector3d;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
namespace fs = std::filesystem;

std::vector<std::string> colmapNames(const Capture& capture) {
  std::vector<std::string> names;
  for (const CaptureView& v : capture.views) names.push_back(v.name);
  return names;
}

// What a model says, in our conventions. Text and binary hold the same.
class ColmapModel : public testing::TestWithParam<bool> {
 protected:
  void SetUp() override { GetParam() ? writeColmapBinary(folder_) : writeColmap(folder_); }
  TemporaryFolder folder_;
};
INSTANTIATE_TEST_SUITE_P(TextAndBinary, ColmapModel, testing::Bool(),
                         [](const auto& info) { return info.param ? "binary" : "text"; });

TEST_P(ColmapModel, ViewsAreOrderedByName) {
  const Capture capture = readColmap(folder_.path());
  EXPECT_EQ(capture.kind, "colmap");
  EXPECT_THAT(colmapNames(capture), ElementsAre("a.jpg", "b.jpg"));
  EXPECT_FALSE(capture.hasScale);
  EXPECT_EQ(capture.metresPerUnit, 1.0);
}

TEST_P(ColmapModel, PosesAreWorldToCameraAndQuaternionsHaveWFirst) {
  const Camera camera = readColmap(folder_.path()).views.at(1).camera;
  // (1, 2, 3) turns to (1, -3, 2), then moves by (10, 20, 30).
  EXPECT_NEAR((camera.camFromWorld * Vector3d(1, 2, 3) - Vector3d(11, 17, 32)).norm(), 0, 1e-13);
  // "The coordinates of the projection/camera center are given by -R^t * T" (format's page).
  EXPECT_NEAR((camera.centreInWorld() - Vector3d(-10, -30, 20)).norm(), 0, 1e-13);
}

TEST_P(ColmapModel, PixelsLoseHalfAPixel) {
  const Camera camera = readColmap(folder_.path()).views.at(0).camera;
  EXPECT_EQ(camera.width, 640);
  EXPECT_EQ(camera.height, 480);
  EXPECT_EQ(camera.pixelFromRay(0, 0), 500);
  EXPECT_EQ(camera.pixelFromRay(1, 1), 510);
  // The middle of 640 x 480 pixels lies between the centres of pixels 319 and 320, and 239 and 240.
  EXPECT_EQ(camera.pixelFromRay(0, 2), 319.5);
  EXPECT_EQ(camera.pixelFromRay(1, 2), 239.5);
}

TEST_P(ColmapModel, AxesAreRightDownForward) {
  const Camera camera = readColmap(folder_.path()).views.at(0).camera;  // stands at z = -5, looks along z
  EXPECT_EQ(camera.depth(Vector3d::Zero()), 5);
  // 1 to the right of the axis at a depth of 5: 500 / 5 = 100 px; 1 down: 510 / 5 = 102 px.
  const auto pixel = camera.project({1, 1, 0});
  ASSERT_TRUE(pixel.has_value());
  EXPECT_NEAR(pixel->x(), 419.5, 1e-12);
  EXPECT_NEAR(pixel->y(), 341.5, 1e-12);
}

TEST_P(ColmapModel, TracksNameViewsAndMeasuredPixels) {
  const Capture capture = readColmap(folder_.path());
  const std::vector<CaptureTrack> tracks = kColmapReader->tracks(capture, {});
  ASSERT_EQ(tracks.size(), 2u);
  EXPECT_EQ(tracks[0].point, Vector3d(1, 2, 3));
  ASSERT_EQ(tracks[0].seen.size(), 2u);
  EXPECT_EQ(tracks[0].seen[0].view, 1);  // number 41 is b.jpg
  EXPECT_EQ(tracks[0].seen[0].measured, Pixel(100, 50));
  EXPECT_EQ(tracks[0].seen[1].view, 0);
  EXPECT_EQ(tracks[0].seen[1].measured, Pixel(320, 240));
  EXPECT_EQ(tracks[1].point, Vector3d(-4, 5, 6));
  ASSERT_EQ(tracks[1].seen.size(), 1u);
  EXPECT_EQ(tracks[1].seen[0].measured, Pixel(6.75, 7.75));
}

TEST_P(ColmapModel, TracksLeaveOutViewsThatTheCallerTookAway) {
  Capture capture = readColmap(folder_.path());
  capture.views.erase(capture.views.begin());
  const std::vector<CaptureTrack> tracks = kColmapReader->tracks(capture, {});
  ASSERT_EQ(tracks.size(), 2u);
  ASSERT_EQ(tracks[0].seen.size(), 1u);
  EXPECT_EQ(tracks[0].seen[0].view, 0);
  EXPECT_EQ(tracks[0].seen[0].measured, Pixel(100, 50));
  EXPECT_TRUE(tracks[1].seen.empty());
}

TEST_P(ColmapModel, ReportSaysWhatWasReadAndConverted) {
  const Capture capture = readColmap(folder_.path());
  const std::string kind = GetParam() ? "binary" : "text";
  EXPECT_THAT(capture.facts, Contains("COLMAP model, " + kind + ": 2 images of 1 camera (PINHOLE 640 x 480), 2 points"));
  EXPECT_THAT(capture.facts, Contains(HasSubstr("0.5 subtracted")));
  const std::string ending = GetParam() ? ".bin" : ".txt";
  EXPECT_THAT(capture.sources,
              ElementsAre(folder_ / ("cameras" + ending), folder_ / ("images" + ending), folder_ / ("points3D" + ending)));
  EXPECT_EQ(capture.file, capture.sources.front());
}

TEST_P(ColmapModel, PointsMayBeMissing) {
  fs::remove(folder_ / (GetParam() ? "points3D.bin" : "points3D.txt"));
  const Capture capture = readColmap(folder_.path());
  EXPECT_EQ(capture.views.size(), 2u);
  EXPECT_THAT(capture.warnings, Contains(HasSubstr("there is no points3D.")));
  EXPECT_TRUE(kColmapReader->tracks(capture, {}).empty());
}

// Camera models: the parameters of each stand on COLMAP's page of camera models and in the comments of its source.
struct ColmapLensRow {
  int number;
  const char* name;
  std::vector<double> parameters;
  double fx, fy;
  LensModel model;
  std::array<double, 8> lens;
};
class ColmapLens : public testing::TestWithParam<ColmapLensRow> {
 protected:
  void expect(const Camera& camera) const {
    const ColmapLensRow& row = GetParam();
    EXPECT_EQ(camera.pixelFromRay(0, 0), row.fx);
    EXPECT_EQ(camera.pixelFromRay(1, 1), row.fy);
    EXPECT_EQ(camera.pixelFromRay(0, 2), 329.5);
    EXPECT_EQ(camera.pixelFromRay(1, 2), 249.5);
    EXPECT_EQ(camera.lens.model, row.model);
    EXPECT_EQ(camera.lens.parameters, row.lens);
  }
};
INSTANTIATE_TEST_SUITE_P(
    Every, ColmapLens,
    testing::Values(
        ColmapLensRow{0, "SIMPLE_PINHOLE", {500, 330, 250}, 500, 500, LensModel::OpenCv, {}},
        ColmapLensRow{1, "PINHOLE", {500, 510, 330, 250}, 500, 510, LensModel::OpenCv, {}},
        ColmapLensRow{2, "SIMPLE_RADIAL", {500, 330, 250, .1}, 500, 500, LensModel::SimpleRadial, {.1}},
        ColmapLensRow{3, "RADIAL", {500, 330, 250, .1, .2}, 500, 500, LensModel::Radial, {.1, .2}},
        ColmapLensRow{4, "OPENCV", {500, 510, 330, 250, .1, .2, .3, .4}, 500, 510, LensModel::OpenCv, {.1, .2, .3, .4}},
        ColmapLensRow{
            5, "OPENCV_FISHEYE", {500, 510, 330, 250, .1, .2, .3, .4}, 500, 510, LensModel::OpenCvFisheye, {.1, .2, .3, .4}},
        ColmapLensRow{6,
                      "FULL_OPENCV",
                      {500, 510, 330, 250, .1, .2, .3, .4, .5, .6, .7, .8},
                      500,
                      510,
                      LensModel::FullOpenCv,
                      {.1, .2, .3, .4, .5, .6, .7, .8}},
        ColmapLensRow{7, "FOV", {500, 510, 330, 250, .9}, 500, 510, LensModel::Fov, {.9}},
        ColmapLensRow{8, "SIMPLE_RADIAL_FISHEYE", {500, 330, 250, .1}, 500, 500, LensModel::SimpleRadialFisheye, {.1}},
        ColmapLensRow{9, "RADIAL_FISHEYE", {500, 330, 250, .1, .2}, 500, 500, LensModel::RadialFisheye, {.1, .2}},
        ColmapLensRow{10,
                      "THIN_PRISM_FISHEYE",
                      {500, 510, 330, 250, .1, .2, .3, .4, .5, .6, .7, .8},
                      500,
                      510,
                      LensModel::ThinPrismFisheye,
                      {.1, .2, .3, .4, .5, .6, .7, .8}}),
    [](const auto& info) { return std::string(info.param.name); });

TEST_P(ColmapLens, OfATextFile) {
  std::ostringstream line;
  line << "7 " << GetParam().name << " 640 480";
  for (const double p : GetParam().parameters) line << " " << p;
  const TemporaryFolder folder;
  writeColmap(folder, "", line.str());
  expect(readColmap(folder.path()).views.at(0).camera);
}

TEST_P(ColmapLens, OfABinaryFile) {
  ColmapBytes b;
  b.u64(1).u32(7).i32(GetParam().number).u64(640).u64(480);
  for (const double p : GetParam().parameters) b.doubles({p});
  const TemporaryFolder folder;
  writeColmapBinary(folder);
  folder.write("cameras.bin", b.text);
  expect(readColmap(folder.path()).views.at(0).camera);
}

// Where a model is found, and its photographs.

TEST(ColmapRecognise, FolderThenSparseThenSparse0) {
  const TemporaryFolder folder;
  EXPECT_EQ(kColmapReader->recognise(folder.path()), "");
  writeColmap(folder, "sparse/0/");
  EXPECT_EQ(kColmapReader->recognise(folder.path()), folder / "sparse/0/cameras.txt");
  writeColmap(folder, "sparse/");
  EXPECT_EQ(kColmapReader->recognise(folder.path()), folder / "sparse/cameras.txt");
  writeColmap(folder);
  EXPECT_EQ(kColmapReader->recognise(folder.path()), folder / "cameras.txt");
  EXPECT_EQ(kColmapReader->recognise(folder / "sparse"), folder / "sparse/cameras.txt");
  EXPECT_EQ(kColmapReader->recognise(folder / "sparse/0"), folder / "sparse/0/cameras.txt");
}

TEST(ColmapRecognise, BinaryBeforeTextUnlessAFileIsNamed) {
  const TemporaryFolder folder;
  writeColmap(folder);
  writeColmapBinary(folder);
  EXPECT_EQ(kColmapReader->recognise(folder.path()), folder / "cameras.bin");
  for (const char* stem : {"cameras", "images", "points3D"}) {
    EXPECT_EQ(kColmapReader->recognise(folder / (std::string(stem) + ".txt")), folder / "cameras.txt") << stem;
    EXPECT_EQ(kColmapReader->recognise(folder / (std::string(stem) + ".bin")), folder / "cameras.bin") << stem;
  }
}

TEST(ColmapRecognise, ByContentNotByName) {
  const TemporaryFolder folder;
  writeColmap(folder);
  for (const char* other : {"", "camera 1\n", "1 pinhole 640 480 1 1 1\n", "1 640 480 500\n", "a.jpg 500 500 320 240\n"}) {
    folder.write("cameras.txt", other);
    EXPECT_EQ(kColmapReader->recognise(folder.path()), "") << other;
  }
  folder.write("cameras.txt", "# Camera list with one line of data per camera:\n");  // a model without cameras; reading says so
  EXPECT_EQ(kColmapReader->recognise(folder.path()), folder / "cameras.txt");
  folder.write("cameras.txt", kColmapCameras);
  fs::remove(folder / "images.txt");
  EXPECT_EQ(kColmapReader->recognise(folder.path()), "");
  EXPECT_EQ(kColmapReader->recognise(folder / "cameras.txt"), "");
}

TEST(ColmapRecognise, NeverThrows) {
  const TemporaryFolder folder;
  EXPECT_EQ(kColmapReader->recognise(""), "");
  EXPECT_EQ(kColmapReader->recognise(folder / "missing"), "");
  EXPECT_EQ(kColmapReader->recognise(std::string("a\0b", 3)), "");
  EXPECT_EQ(kColmapReader->recognise(std::string(100000, 'x')), "");
  fs::create_directories(folder / "cameras.txt");  // folders in place of files
  fs::create_directories(folder / "images.txt");
  EXPECT_EQ(kColmapReader->recognise(folder.path()), "");
  EXPECT_EQ(kColmapReader->recognise(folder / "cameras.txt"), "");
}

TEST(ColmapProject, PhotographsLieInImagesOfTheRoot) {
  for (const char* model : {"", "sparse/", "sparse/0/", "sparse/12/"}) {
    const TemporaryFolder folder;
    writeColmap(folder, model);
    folder.write("images/a.jpg", "x");
    folder.write("b.jpg", "x");  // not in `images`: in the root
    const Capture capture = readColmap(folder / model);
    EXPECT_EQ(capture.folder, fs::path((folder / "x").parent_path())) << model;
    EXPECT_EQ(capture.views.at(0).image, folder / "images/a.jpg") << model;
    EXPECT_EQ(capture.views.at(1).image, folder / "b.jpg") << model;
    EXPECT_THAT(capture.facts, Contains("photographs found: 2 of 2")) << model;
    EXPECT_THAT(capture.warnings, ElementsAre()) << model;
  }
}

TEST(ColmapProject, PhotographsMayLieBesideTheModelOrInAFolderThatIsNamed) {
  const TemporaryFolder folder, others;
  writeColmap(folder, "sparse/0/");
  folder.write("sparse/0/a.jpg", "x");
  EXPECT_EQ(readColmap(folder.path()).views.at(0).image, folder / "sparse/0/a.jpg");
  others.write("a.jpg", "x");
  CaptureOptions options;
  options.photographs = {others.path()};
  const Capture capture = readColmap(folder.path(), options);
  EXPECT_EQ(capture.views.at(0).image, others / "a.jpg");
  EXPECT_EQ(capture.views.at(1).image, folder / "images/b.jpg");  // missing: where it would be first
  EXPECT_THAT(capture.warnings, Contains(HasSubstr("1 photograph of 2 not found")));
}

// The undistorted images of `dense` belong to its cameras, those of the folder above do not.
// As mip-NeRF 360 and nerfstudio keep them, where a person has only those.
TEST(ColmapProject, SmallerCopiesStandInForAFolderThatIsMissing) {
  const TemporaryFolder folder;
  writeColmap(folder, "sparse/0/", kColmapCameras, with(kColmapImages, "b.jpg", "left/b.jpg"));
  folder.write("images_4/a.jpg", "x");
  folder.write("images_4/left/B.JPG", "x");
  const auto imageOf = [&](std::size_t view) { return readColmap(folder.path()).views.at(view).image; };
  EXPECT_EQ(imageOf(0), folder / "images_4/a.jpg");
  EXPECT_EQ(imageOf(1), folder / "images_4/left/B.JPG");
  EXPECT_THAT(readColmap(folder.path()).warnings,
              Contains("the photographs are those of the folder images_4: images has no such files"));
  fs::create_directories(folder / "images");
  EXPECT_EQ(imageOf(0), folder / "images_4/a.jpg");
  folder.write("images_2/a.jpg", "x");  // the larger one
  EXPECT_EQ(imageOf(0), folder / "images_2/a.jpg");
  folder.write("images/a.jpg", "x");
  EXPECT_EQ(imageOf(0), folder / "images/a.jpg");
  EXPECT_EQ(imageOf(1), folder / "images/left/b.jpg");  // missing: sizes are not mixed
  CaptureOptions options;
  options.photographs = {folder / "images_4"};
  EXPECT_EQ(readColmap(folder.path(), options).views.at(0).image, folder / "images_4/a.jpg");
}

TEST(ColmapProject, DenseIsAProjectOfItsOwn) {
  const TemporaryFolder folder;
  writeColmap(folder, "dense/sparse/");
  folder.write("dense/images/a.jpg", "x");
  folder.write("images/a.jpg", "x");
  EXPECT_EQ(readColmap(folder / "dense/sparse").views.at(0).image, folder / "dense/images/a.jpg");
  EXPECT_EQ(readColmap(folder / "dense").folder, folder / "dense");
}

TEST(ColmapProject, OtherModelsAreNamed) {
  const TemporaryFolder folder;
  for (const char* model : {"sparse/0/", "sparse/10/", "sparse/2/"}) writeColmap(folder, model);
  fs::create_directories(folder / "sparse/3");  // no model
  EXPECT_THAT(readColmap(folder.path()).warnings, Contains(HasSubstr("not read: sparse/2, sparse/10;")));
  EXPECT_THAT(readColmap(folder / "sparse/2").warnings, Contains(HasSubstr("not read: sparse/0, sparse/10;")));
}

TEST(ColmapProject, NamesThatLeaveTheFolderAreRefusedUnlessAllowed) {
  const TemporaryFolder folder;
  writeColmap(folder, "", kColmapCameras, with(kColmapImages, "a.jpg", "../../a.jpg"));
  EXPECT_THROW(readColmap(folder.path()), OutsidePath);
  CaptureOptions options;
  options.rights.anywhere = true;
  EXPECT_EQ(readColmap(folder.path(), options).views.size(), 2u);
}

// Texts that COLMAP and people write.

Capture readColmapImages(const std::string& images) {
  const TemporaryFolder folder;
  writeColmap(folder, "", kColmapCameras, images, "");
  return readColmap(folder.path());
}

TEST(ColmapText, NameIsTheRestOfTheLine) {
  EXPECT_EQ(readColmapImages("1 1 0 0 0 0 0 5 7 photos of a/first  one.jpg \n\n").views.at(0).name, "photos of a/first  one.jpg");
}

TEST(ColmapText, ImagesWithout2DPoints) {
  EXPECT_THAT(colmapNames(readColmapImages("1 1 0 0 0 0 0 5 7 a\n\n2 1 0 0 0 0 0 5 7 b\n\n3 1 0 0 0 0 0 5 7 c\n1 2 -1\n")),
              ElementsAre("a", "b", "c"));
  EXPECT_THAT(colmapNames(readColmapImages("1 1 0 0 0 0 0 5 7 a\n\n2 1 0 0 0 0 0 5 7 b")), ElementsAre("a", "b"));
}

TEST(ColmapText, CommentsAndEmptyLinesStandBeforeAndBetweenImages) {
  EXPECT_THAT(colmapNames(readColmapImages("# one\n\n1 1 0 0 0 0 0 5 7 a\n\n\n  # two\n2 1 0 0 0 0 0 5 7 b\n1 2 -1\n# end\n")),
              ElementsAre("a", "b"));
}

TEST(ColmapText, WindowsLineEnds) {
  const auto windows = [](const std::string& text) {
    std::string out;
    for (const char c : text) out += c == '\n' ? "\r\n" : std::string(1, c);
    return out;
  };
  const TemporaryFolder folder;
  writeColmap(folder, "", windows(kColmapCameras), windows(kColmapImages) + "9 1 0 0 0 0 0 5 7 c.jpg\r\n\r\n",
              windows(kColmapPoints));
  const Capture capture = readColmap(folder.path());
  EXPECT_THAT(colmapNames(capture), ElementsAre("a.jpg", "b.jpg", "c.jpg"));
  EXPECT_EQ(kColmapReader->tracks(capture, {}).at(0).seen.at(0).measured, Pixel(100, 50));
}

TEST(ColmapText, NumbersAreAnyOf32Bits) {
  const TemporaryFolder folder;
  writeColmap(folder, "", with(kColmapCameras, "7 PINHOLE", "4294967295 PINHOLE"),
              "4000000000 1 0 0 0 0 0 5 4294967295 a.jpg\n1 2 -1\n", "18000000000000000000 1 2 3 4 5 6 0 4000000000 0\n");
  const Capture capture = readColmap(folder.path());
  EXPECT_EQ(kColmapReader->tracks(capture, {}).at(0).seen.size(), 1u);
}

TEST(ColmapText, QuaternionsOfOtherLengthsAreNormalisedAndCounted) {
  std::string images;
  for (int i = 10; i < 30; ++i) images += std::to_string(i) + " 2 2 0 0 10 20 30 7 " + std::to_string(i) + ".jpg\n\n";
  const Capture capture = readColmapImages(images);
  for (const CaptureView& v : capture.views)
    EXPECT_NEAR((v.camera.camFromWorld * Vector3d(1, 2, 3) - Vector3d(11, 17, 32)).norm(), 0, 1e-13) << v.name;
  const auto isOfQuaternion = [](const std::string& w) { return w.find("quaternion") != std::string::npos; };
  EXPECT_EQ(std::count_if(capture.warnings.begin(), capture.warnings.end(), isOfQuaternion), 8);
  EXPECT_THAT(capture.warnings, Contains("and 12 more such warnings"));
}

// A person took an image out of images.txt; points3D.txt still names it.
TEST(ColmapTracks, WhatTheModelDoesNotHaveIsCountedAndLeftOut) {
  const TemporaryFolder folder;
  writeColmap(folder, "", kColmapCameras, kColmapImages, "3 1 2 3 1 2 3 0.5 41 1 8 0 4 2 4 1 9 9\n");
  const Capture capture = readColmap(folder.path());
  EXPECT_THAT(
      capture.warnings,
      Contains(HasSubstr("of 5 entries in tracks of points, 2 name an image and 1 a 2D point that the model does not have")));
  const std::vector<CaptureTrack> tracks = kColmapReader->tracks(capture, {});
  ASSERT_EQ(tracks.size(), 1u);
  ASSERT_EQ(tracks[0].seen.size(), 2u);
  EXPECT_EQ(tracks[0].seen[1].measured, Pixel(6.75, 7.75));
}

// Real models. `colmap model_analyzer` (3.8) says of the binary one: 11 images, 7862 points, 37123 observations, mean
// reprojection error 0.604344 px. The error of a point is the mean distance of its pixels from where its cameras show it.

std::vector<double> colmapErrors(const Capture& capture) {
  std::vector<double> errors;
  for (const CaptureTrack& track : kColmapReader->tracks(capture, {})) {
    double sum = 0;
    for (const auto& [view, measured] : track.seen) {
      const Camera& camera = capture.views[std::size_t(view)].camera;
      sum += (camera.distorted(camera.project(track.point).value()) - measured).norm();
    }
    errors.push_back(sum / double(track.seen.size()));
  }
  return errors;
}

TEST(ColmapRealModel, BinaryHasTheErrorsThatColmapWroteForIt) {
  GLINT_NEEDS_SHARED_DATA();
  const fs::path folder = fs::path(GLINT_SHARED_DIR) / "data/colmap_model/binary";
  const Capture capture = readColmap(folder);
  EXPECT_EQ(capture.views.size(), 11u);
  EXPECT_THAT(capture.facts, Contains(HasSubstr("11 images of 1 camera (SIMPLE_RADIAL 2832 x 2128), 7862 points")));
  const std::vector<double> errors = colmapErrors(capture);
  ASSERT_EQ(errors.size(), 7862u);
  // points3D.bin: a point is 35 bytes, its error, the length of its track, 8 bytes for each entry.
  const std::string bytes = contentOf(folder / "points3D.bin");
  double sum = 0, worst = 0;
  std::size_t at = 8, entries = 0;
  for (const double error : errors) {
    double said = 0;
    std::uint64_t length = 0;
    std::memcpy(&said, bytes.data() + at + 35, sizeof said);
    std::memcpy(&length, bytes.data() + at + 43, sizeof length);
    at += 51 + 8 * length;
    entries += length;
    sum += error;
    worst = std::max(worst, std::abs(error - said));
  }
  EXPECT_EQ(at, bytes.size());
  EXPECT_EQ(entries, 37123u);
  EXPECT_LT(worst, 1e-11);  // round-off of pixels of order 1e3; measured: 5e-13
  EXPECT_NEAR(sum / double(errors.size()), 0.604344, 5e-7);
}

TEST(ColmapRealModel, TextHasTheErrorsThatColmapWroteForIt) {
  GLINT_NEEDS_SHARED_DATA();
  const fs::path folder = fs::path(GLINT_SHARED_DIR) / "data/colmap_model/text";
  const std::vector<double> errors = colmapErrors(readColmap(folder));
  ASSERT_EQ(errors.size(), 7862u);
  std::istringstream lines(contentOf(folder / "points3D.txt"));
  std::size_t i = 0;
  double worst = 0;
  for (std::string line; std::getline(lines, line);) {
    if (line.front() == '#') continue;
    std::istringstream words(line);
    double id, x, y, z, r, g, b, said;
    words >> id >> x >> y >> z >> r >> g >> b >> said;
    worst = std::max(worst, std::abs(errors.at(i++) - said));
  }
  EXPECT_EQ(i, errors.size());
  EXPECT_LT(worst, 0.01);  // poses, points and pixels are printed with 6 digits; measured: 0.006
}

}  // namespace
}  // namespace glint::colmap_tests
