// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "core/scene/capture.h"
#include "tests/core/scene/nerfstudio_fixture.h"
#include "tests/core/scene/scene_fixture.h"
#include "tests/tolerances.h"

// The written file is read by the JSON library and compared with nerfstudio's definition of a ray; the round trip goes through
// our reader.

namespace glint::nerfstudio_write_tests {
namespace {
using namespace testing_support;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
namespace fs = std::filesystem;

constexpr double kFile17Digits = 1e-12;  // a number of order 1 that was printed with 17 digits and read again
constexpr double kRoundTripPx = 1e-9;    // a pixel of order 1e3, after printing and reading

Camera skewedView(int i, const Lens& lens) {
  Camera camera;
  camera.width = 1920;
  camera.height = 1080;
  camera.pixelFromRay << 1500.0 / 7, 0, 959.123456789012345, 0, 1501.0 / 7, 541.7654321098765, 0, 0, 1;
  camera.lens = lens;
  camera.camFromWorld =
      Eigen::AngleAxisd(0.3 + i, Eigen::Vector3d(1, 2, -0.5 * i).normalized()) * Eigen::Translation3d(0.1 * i, -1.0 / 3, 2.5);
  return camera;
}

TEST(WriteTransforms, RaysOfNerfstudioAreOurs) {
  const TemporaryFolder folder;
  const Camera camera = skewedView(1, {});
  writeTransforms({{"images/a.png", camera, "", ""}}, folder / "transforms.json");
  const nlohmann::json j = nlohmann::json::parse(contentOf(folder / "transforms.json"));
  Eigen::Matrix4d transform;
  for (std::size_t r = 0; r < 4; ++r)
    for (std::size_t c = 0; c < 4; ++c)
      transform(Eigen::Index(r), Eigen::Index(c)) = j.at("frames").at(0).at("transform_matrix").at(r).at(c).get<double>();
  EXPECT_EQ(transform.row(3), Eigen::RowVector4d(0, 0, 0, 1));
  EXPECT_NEAR(transform.topLeftCorner(3, 3).determinant(), 1, tolerance::kExact);
  EXPECT_NEAR((transform.topRightCorner<3, 1>() - camera.centreInWorld()).norm(), 0, tolerance::kExact);
  EXPECT_EQ(j.at("cx").get<double>(), 959.123456789012345 + 0.5);
  for (const Pixel& p : {Pixel(0, 0), Pixel(1919, 3), Pixel(7, 1079)})
    EXPECT_NEAR(
        (camera.ray(p).direction - rayOfNerfstudio(transform, j.at("fl_x"), j.at("fl_y"), j.at("cx"), j.at("cy"), p.x(), p.y()))
            .norm(),
        0, tolerance::kExact);
  EXPECT_EQ(j.at("w"), 1920);
  EXPECT_EQ(j.at("h"), 1080);
  EXPECT_EQ(j.at("camera_model"), "OPENCV");
  EXPECT_EQ(j.at("frames").at(0).at("file_path"), "images/a.png");
  EXPECT_FALSE(j.at("frames").at(0).contains("depth_file_path"));
  EXPECT_FALSE(j.at("frames").at(0).contains("fl_x"));
  EXPECT_FALSE(j.contains("ply_file_path"));
}

TEST(WriteTransforms, LensesUnderNerfstudiosNames) {
  struct Row {
    Lens lens;
    const char* model;
    std::map<std::string, double> terms;
  };
  for (const Row& row : {Row{{LensModel::OpenCv, {0.1, 0.2, 0.01, 0.02, 0.3}},
                             "OPENCV",
                             {{"k1", 0.1}, {"k2", 0.2}, {"p1", 0.01}, {"p2", 0.02}, {"k3", 0.3}}},
                         Row{{LensModel::SimpleRadial, {0.1}}, "SIMPLE_RADIAL", {{"k1", 0.1}}},
                         Row{{LensModel::Radial, {0.1, 0.2}}, "RADIAL", {{"k1", 0.1}, {"k2", 0.2}}},
                         Row{{LensModel::OpenCvFisheye, {0.1, 0.2, 0.3, 0.4}},
                             "OPENCV_FISHEYE",
                             {{"k1", 0.1}, {"k2", 0.2}, {"k3", 0.3}, {"k4", 0.4}}}}) {
    const TemporaryFolder folder;
    writeTransforms({{"a.png", skewedView(0, row.lens), "", ""}}, folder / "transforms.json");
    const nlohmann::json j = nlohmann::json::parse(contentOf(folder / "transforms.json"));
    EXPECT_EQ(j.at("camera_model"), row.model);
    std::map<std::string, double> terms;
    for (const char* key : {"k1", "k2", "k3", "k4", "k5", "k6", "p1", "p2"})
      if (j.contains(key)) terms[key] = j.at(key).get<double>();
    EXPECT_EQ(terms, row.terms) << row.model;
    EXPECT_EQ(nerfstudioReader().read(folder / "transforms.json", {}).views.at(0).camera.lens, row.lens) << row.model;
  }
}

TEST(WriteTransforms, RoundTrip) {
  for (const bool shared : {true, false}) {
    const TemporaryFolder folder;
    std::vector<PosedImage> images;
    for (int i = 0; i < 9; ++i) {
      images.push_back({"images/" + std::to_string(i) + ".png",
                        skewedView(i, {LensModel::OpenCv, {0.01, -0.02, 1e-4, -2e-4, 0.003}}),
                        "depth/" + std::to_string(i) + ".png", "masks/" + std::to_string(i) + ".png"});
      if (!shared) images.back().camera.pixelFromRay(0, 0) += i;
    }
    writeTransforms(images, folder / "transforms.json", "points.ply");
    const nlohmann::json j = nlohmann::json::parse(contentOf(folder / "transforms.json"));
    EXPECT_EQ(j.contains("fl_x"), shared);
    EXPECT_EQ(j.at("frames").at(0).contains("fl_x"), !shared);
    EXPECT_EQ(j.at("frames").at(0).contains("k3"), !shared);
    EXPECT_EQ(j.at("ply_file_path"), "points.ply");
    const Capture capture = nerfstudioReader().read(folder / "transforms.json", {});
    EXPECT_THAT(capture.warnings, ElementsAre(HasSubstr("there is no 'points.ply'")));  // the points are written by others
    ASSERT_EQ(capture.views.size(), images.size());
    for (std::size_t i = 0; i < images.size(); ++i) {
      const Camera &was = images[i].camera, &is = capture.views[i].camera;
      EXPECT_EQ(capture.views[i].name, images[i].name);
      EXPECT_EQ(capture.views[i].depth, folder / images[i].depth);
      EXPECT_EQ(capture.views[i].depthScale, 0.001);
      EXPECT_EQ(capture.views[i].mask, folder / images[i].mask);
      EXPECT_NEAR((was.centreInWorld() - is.centreInWorld()).norm(), 0, kFile17Digits);
      EXPECT_EQ(was.lens, is.lens);
      EXPECT_EQ(was.width, is.width);
      for (const Pixel& p : {Pixel(0, 0), Pixel(1919, 0), Pixel(300, 1079)}) {
        const Eigen::Vector3d x = was.ray(p).at(3);
        EXPECT_NEAR((is.project(x).value() - p).norm(), 0, kRoundTripPx);
      }
    }
  }
}

TEST(WriteTransforms, RadialLensesBesideOpenCvBecomeOne) {
  const TemporaryFolder folder;
  writeTransforms({{"a.png", skewedView(0, {LensModel::SimpleRadial, {0.1}}), "", ""},
                   {"b.png", skewedView(1, {LensModel::OpenCv, {0.2, 0, 0.01}}), "", ""}},
                  folder / "transforms.json");
  const nlohmann::json j = nlohmann::json::parse(contentOf(folder / "transforms.json"));
  EXPECT_EQ(j.at("camera_model"), "OPENCV");
  EXPECT_EQ(j.at("frames").at(0).at("k1"), 0.1);
  EXPECT_EQ(j.at("frames").at(0).at("p1"), 0.0);
  EXPECT_EQ(j.at("frames").at(1).at("p1"), 0.01);
}

TEST(WriteTransforms, WhatNerfstudioDoesNotHaveIsRefusedAndNothingIsWritten) {
  const TemporaryFolder folder;
  const fs::path file = folder / "transforms.json";
  for (const LensModel model : kLensModels) {
    const bool known = model == LensModel::OpenCv || model == LensModel::SimpleRadial || model == LensModel::Radial ||
                       model == LensModel::OpenCvFisheye;
    if (known) continue;
    EXPECT_THAT(inputErrorOf([&] {
                  writeTransforms({{"a.png", skewedView(0, {}), "", ""}, {"b.png", skewedView(1, {model, {0.1}}), "", ""}}, file);
                }),
                testing::AllOf(HasSubstr(file.string() + ": frames[1]: 'b.png'"), HasSubstr(nameOf(model))));
  }
  EXPECT_THAT(inputErrorOf([&] {
                writeTransforms(
                    {{"a.png", skewedView(0, {}), "", ""}, {"b.png", skewedView(1, {LensModel::OpenCvFisheye, {0.1}}), "", ""}},
                    file);
              }),
              HasSubstr("one camera model for all images"));
  Camera skew = skewedView(0, {});
  skew.pixelFromRay(0, 1) = 1e-3;
  EXPECT_THAT(inputErrorOf([&] { writeTransforms({{"a.png", skew, "", ""}}, file); }), HasSubstr("frames[0]: 'a.png' has skew"));
  EXPECT_THAT(inputErrorOf([&] { writeTransforms({{"a\xFF.png", skewedView(0, {}), "", ""}}, file); }), HasSubstr("not UTF-8"));
  EXPECT_THAT(inputErrorOf([&] { writeTransforms({{"", skewedView(0, {}), "", ""}}, file); }), HasSubstr("has no name"));
  EXPECT_FALSE(fs::exists(file));
  EXPECT_THROW(writeTransforms({}, file), std::invalid_argument);
  Camera broken = skewedView(0, {});
  broken.camFromWorld.translation().x() = std::nan("");
  EXPECT_THROW(writeTransforms({{"a.png", broken, "", ""}}, file), std::invalid_argument);
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

}  // namespace
}  // namespace glint::nerfstudio_write_tests
