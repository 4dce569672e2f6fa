// SPDX-License-Identifier: BSD-3-Clause
// Masks: which pixels they hold, and what the folder of labels looks like.
#include "core/report/masks.h"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <set>

#include "core/report/labels.h"
#include "tests/core/pipeline/exact_scene.h"

namespace glint {
namespace {

namespace fs = std::filesystem;

Camera camera(int width, int height) {
  Camera c;
  c.pixelFromRay << 100, 0, 20, 0, 100, 15, 0, 0, 1;
  c.width = width;
  c.height = height;
  return c;
}

long long count(const Image& mask) { return std::count(mask.data.begin(), mask.data.end(), 255.f); }

fs::path emptyFolder(const std::string& name) {
  std::string pattern = (fs::path(testing::TempDir()) / "glint-XXXXXX").string();  // tests run beside each other
  const fs::path folder = fs::path(mkdtemp(pattern.data())) / name;
  return folder;
}

TEST(MaskOf, HoldsThePixelsWhoseCentresAreInside) {
  // 2.5 <= x <= 7.5 holds the centres 3 .. 7; 1 - eps <= y <= 3 + eps holds 1, 2, 3.
  const Image mask = maskOf({Polyline{{{2.5, 0.9}, {7.5, 0.9}, {7.5, 3.1}, {2.5, 3.1}}, true}}, camera(40, 30));
  ASSERT_EQ(mask.width, 40);
  ASSERT_EQ(mask.height, 30);
  for (int y = 0; y < 30; ++y)
    for (int x = 0; x < 40; ++x) EXPECT_EQ(mask.at(x, y) > 0, x >= 3 && x <= 7 && y >= 1 && y <= 3) << x << " " << y;
}

TEST(MaskOf, AreaOfACircle) {
  Polyline circle{{}, true};
  for (int i = 0; i < 720; ++i)
    circle.points.push_back(Pixel(100.3, 80.7) + 60 * Pixel(std::cos(i * M_PI / 360), std::sin(i * M_PI / 360)));
  EXPECT_NEAR(double(count(maskOf({circle}, camera(220, 180)))), M_PI * 3600,
              40);  // lattice points: error of the order of r^(2/3)
}

TEST(MaskOf, IsCutAtTheBorderAndUnitesContours) {
  const Polyline left{{{-5, -5}, {3.5, -5}, {3.5, 40}, {-5, 40}}, true},
      again{{{1.5, 2.5}, {9.5, 2.5}, {9.5, 4.5}, {1.5, 4.5}}, true};
  const Image mask = maskOf({left, again}, camera(40, 30));
  EXPECT_EQ(count(mask), 4 * 30 + 6 * 2);
  EXPECT_EQ(mask.at(0, 29), 255);
  EXPECT_EQ(mask.at(9, 3), 255);
}

TEST(MaskOf, PutsLensDistortionBack) {
  Camera bent = camera(40, 30);
  bent.lens.parameters = {-0.5, 0, 0, 0, 0};
  const Polyline square{{{36.5, 13.5}, {38.5, 13.5}, {38.5, 16.5}, {36.5, 16.5}}, true};
  // x_d = x (1 - 0.5 r^2): at 17.5 / 100 from the centre 1.5 % shorter, 0.27 px; the centre 37 stays in, and 38 falls out
  // of 38.22.
  EXPECT_EQ(maskOf({square}, bent).at(38, 15), 255);
  bent.lens.parameters = {-2, 0, 0, 0, 0};  // 38.5 -> 37.23
  EXPECT_EQ(maskOf({square}, bent).at(38, 15), 0);
  EXPECT_EQ(maskOf({square}, bent).at(37, 15), 255);
}

TEST(MaskOf, DegenerateContoursHoldNothing) {
  EXPECT_EQ(count(maskOf({}, camera(40, 30))), 0);
  EXPECT_EQ(count(maskOf({Polyline{{{1, 1}, {20, 20}}, true}}, camera(40, 30))), 0);
  const double nan = std::nan("");
  EXPECT_EQ(count(maskOf({Polyline{{{nan, 1}, {nan, nan}, {2, 3}}, true}}, camera(40, 30))), 0);
}

Inspection small() {
  InspectionRequest request;
  request.models = {"canonical", "limit-angle"};
  request.train = "first:4";
  return inspect(testing_support::exactScene(testing_support::sphere(1.0), 5), request);
}

TEST(WriteLabels, OneMaskPerFrameLightAndSource) {
  const Inspection inspection = small();
  const fs::path folder = emptyFolder("labels");
  writeLabels(inspection, folder);
  std::ifstream in(folder / "masks.json");
  const nlohmann::json index = nlohmann::json::parse(in);
  ASSERT_EQ(index["masks"].size(), 5u * 3u);
  for (const auto& row : index["masks"]) {
    const cv::Mat mask = cv::imread((folder / row["file"].get<std::string>()).string(), cv::IMREAD_UNCHANGED);
    ASSERT_EQ(mask.type(), CV_8UC1) << row;
    EXPECT_EQ(mask.cols, 640);
    EXPECT_EQ(mask.rows, 480);
    int inside = 0;
    for (int y = 0; y < mask.rows; ++y)
      for (int x = 0; x < mask.cols; ++x) inside += mask.at<unsigned char>(y, x) == 255;
    EXPECT_EQ(inside, row["pixels"].get<int>());
    // Exact contours: predicted and observed hold nearly the same pixels.
    double area = 0;
    for (const Highlight& h : inspection.evidence[row["frame"].get<std::size_t>()].highlights)
      area += std::abs(signedArea(h.contour));
    EXPECT_NEAR(inside, area, 0.15 * area) << row;
  }
  EXPECT_TRUE(fs::exists(folder / "labels_canonical.json"));
  EXPECT_EQ(fs::file_size(folder / "labels_limit-angle.json") > 1000, true);
}

/// Names of lights may hold what no folder may: two that differ only there do not share their masks.
TEST(WriteLabels, LightsThatAFolderCannotTellApartGetFoldersOfTheirOwn) {
  InspectionRequest request;
  request.models = {"canonical"};
  request.train = "first:6";
  const std::vector<testing_support::NamedLight> lamps{{"lamp 1", {0.1, 0.2, 1.4}}, {"lamp/1", {-0.25, 0.1, 1.4}}};
  const Inspection inspection = inspect(
      testing_support::exactScene(testing_support::sphere(1.0), lamps, 6, [&](int i) { return std::vector{lamps[i % 2].id}; }),
      request);
  const fs::path folder = emptyFolder("twins");
  writeLabels(inspection, folder);
  std::ifstream in(folder / "masks.json");
  const nlohmann::json index = nlohmann::json::parse(in);
  ASSERT_EQ(index["masks"].size(), 6u * 2u * 2u);
  std::set<std::string> named;
  for (const auto& row : index["masks"]) {
    const std::string file = row["file"];
    EXPECT_TRUE(named.insert(file).second) << file << " is two masks";
    const cv::Mat mask = cv::imread((folder / file).string(), cv::IMREAD_UNCHANGED);
    EXPECT_EQ(cv::countNonZero(mask), row["pixels"].get<int>()) << file;
    const bool on = row["light"].get<std::string>() == lamps[row["frame"].get<std::size_t>() % 2].id;
    EXPECT_EQ(row["pixels"].get<int>() > 0, on) << row;
  }
}

// A reader of the labels must not look for files that are missing.
TEST(CocoJson, WithoutAPhotographTheFileNameIsTheFramesIdAndANoteSaysSo) {
  const Inspection inspection = small();
  const std::vector<int> frames{0, 1, 2};
  const auto labels = [&](const Inspection& in) { return nlohmann::json::parse(cocoJson(in, "canonical", frames)); };
  const fs::path folder = emptyFolder("coco");
  fs::create_directories(folder / "frames");
  Scene scene = *inspection.scene;
  scene.folder = folder;
  scene.frames[0].image.clear();  // synthesised with the scene: none is named
  scene.frames[0].radiance.clear();
  scene.frames[1].image = folder / "frames/gone.png";
  scene.frames[2].image = folder / "frames/there.png";
  std::ofstream(folder / "frames/there.png") << "a picture";
  Inspection mixed = inspection;
  mixed.scene = std::make_shared<const Scene>(scene);
  const nlohmann::json some = labels(mixed);
  EXPECT_EQ(some["images"][0]["file_name"], scene.frames[0].id);
  EXPECT_EQ(some["images"][1]["file_name"], scene.frames[1].id);
  EXPECT_EQ(some["images"][2]["file_name"], "frames/there.png");
  EXPECT_TRUE(some["images"][0].contains("note") && some["images"][1].contains("note"));
  EXPECT_FALSE(some["images"][2].contains("note"));
  EXPECT_EQ(some["info"]["note"].get<std::string>().substr(0, 11), "2 of 3 imag");
  // The photograph is there, and shows other highlights than those that are labelled.
  mixed.request.whatIf.synthesise = true;
  EXPECT_EQ(labels(mixed)["images"][2]["file_name"], scene.frames[2].id);
}

// With r = -1 the term of NVM shows nothing farther than (2/3) sqrt(1/3) = 0.385 from the axis, 38.5 px at f = 100. The contour
// here reaches from 30 to 50 px; without a number there is no point of a polygon.
TEST(CocoJson, LeavesOutWhatTheLensDoesNotShow) {
  Inspection inspection = small();
  Scene scene = *inspection.scene;
  Camera& camera = scene.frames[0].camera;
  camera.pixelFromRay << 100, 0, 0, 0, 100, 100, 0, 0, 1;
  camera.lens = {LensModel::VisualSfm, {-1}};
  inspection.scene = std::make_shared<const Scene>(scene);
  FrameComparison& first = inspection.models.at("canonical").frames.at(0);
  ASSERT_EQ(first.frame, 0);
  first.prediction.editable()[0].contour = Polyline{{{30, 100}, {36, 96}, {50, 100}, {36, 104}}, true};
  const nlohmann::json labels = nlohmann::json::parse(cocoJson(inspection, "canonical", {0}));
  const nlohmann::json& polygon = labels.at("annotations").at(0).at("segmentation").at(0);
  EXPECT_EQ(polygon.size(), 6u);
  EXPECT_EQ(labels.at("annotations").at(0).at("attributes").at("truncated"), true);
  for (const nlohmann::json& number : polygon) EXPECT_TRUE(number.is_number());
}

TEST(WriteLabels, StoppedOrRefusedLeavesNothing) {
  const Inspection inspection = small();
  const fs::path parent = emptyFolder("stopped"), folder = parent / "labels";
  fs::create_directories(parent);
  EXPECT_THROW(writeLabels(inspection, folder, [](const StageEvent&) { return false; }), Stopped);
  EXPECT_TRUE(fs::is_empty(parent));
  fs::create_directories(folder);
  std::ofstream(folder / "mine.txt") << "keep";
  EXPECT_THROW(writeLabels(inspection, folder), InputError);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder), fs::directory_iterator()), 1);
  EXPECT_EQ(std::distance(fs::directory_iterator(parent), fs::directory_iterator()), 1);
}

}  // namespace
}  // namespace glint
