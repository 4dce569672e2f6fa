// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/scene/capture.h"
#include "tests/core/scene/nerfstudio_fixture.h"
#include "tests/core/scene/scene_fixture.h"
#include "tests/tolerances.h"

// Expected values come from nerfstudio's definition of a ray, from hand computations written beside them, and from the way in
// which nerfstudio converts COLMAP's poses; none from the reader.

namespace glint::nerfstudio_tests {
namespace {
using namespace testing_support;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
namespace fs = std::filesystem;

/// A picture of the given size, as a binary PPM: formats are told by content, not by name.
std::string picture(int width, int height) {
  return "P6\n" + std::to_string(width) + " " + std::to_string(height) + "\n255\n" +
         std::string(std::size_t(3 * width * height), '\x40');
}

// ---- Conventions --------------------------------------------------------------------------------------------------------------

TEST(Nerfstudio, LooksAlongMinusZWithYUpAndCountsFromTheCorner) {
  const Camera camera = cameraOf(minimalTransforms());
  EXPECT_EQ(camera.width, 64);
  EXPECT_EQ(camera.height, 48);
  // 32 and 24 from the corner are 31.5 and 23.5 from the centre of the first pixel.
  EXPECT_EQ(camera.pixelFromRay(0, 2), 31.5);
  EXPECT_EQ(camera.pixelFromRay(1, 2), 23.5);
  EXPECT_EQ(camera.pixelFromRay(0, 0), 100);
  EXPECT_EQ(camera.pixelFromRay(1, 1), 120);
  EXPECT_THAT(camera.centreInWorld(), testing::Eq(Eigen::Vector3d(1, 2, 3)));
  // 2 in front is z = 1; half a unit to the right is 100 * 0.5 / 2 = 25 px, half a unit up is 120 * 0.5 / 2 = 30 px upwards.
  EXPECT_EQ(camera.depth({1, 2, 1}), 2);
  EXPECT_FALSE(camera.project({1, 2, 5}));  // behind
  const Pixel p = camera.project({1.5, 2.5, 1}).value();
  EXPECT_NEAR(p.x(), 31.5 + 25, tolerance::kExact);
  EXPECT_NEAR(p.y(), 23.5 - 30, tolerance::kExact);
}

TEST(Nerfstudio, TheMatrixIsCameraToWorld) {
  // A quarter turn about y: the camera's x axis (first column) is the world's -z, and it looks along the world's -x.
  const Camera camera = cameraOf(with(minimalTransforms(), kIdentityPose, "[[0,0,1,1],[0,1,0,2],[-1,0,0,3],[0,0,0,1]]"));
  EXPECT_NEAR((camera.centreInWorld() - Eigen::Vector3d(1, 2, 3)).norm(), 0, tolerance::kExact);
  EXPECT_NEAR(camera.depth({-1, 2, 3}), 2, tolerance::kExact);
  const Pixel p = camera.project({-1, 2, 2.5}).value();  // half a unit towards -z: to the right
  EXPECT_NEAR(p.x(), 31.5 + 25, tolerance::kExact);
  EXPECT_NEAR(p.y(), 23.5, tolerance::kExact);
}

TEST(Nerfstudio, RaysAreThoseOfNerfstudio) {
  Eigen::Matrix4d transform = Eigen::Matrix4d::Identity();
  transform.topLeftCorner<3, 3>() = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, -2, 0.5).normalized()).toRotationMatrix();
  transform.topRightCorner<3, 1>() = Eigen::Vector3d(-0.3, 4, 2);
  nlohmann::json rows = nlohmann::json::array();
  for (int i = 0; i < 4; ++i) rows.push_back({transform(i, 0), transform(i, 1), transform(i, 2), transform(i, 3)});
  const Camera camera = cameraOf(with(minimalTransforms(), kIdentityPose, rows.dump()));
  for (const Pixel& p : {Pixel(0, 0), Pixel(63, 0), Pixel(10, 47), Pixel(31.5, 23.5)}) {
    const Ray ray = camera.ray(p);
    EXPECT_NEAR((ray.origin - Eigen::Vector3d(-0.3, 4, 2)).norm(), 0, tolerance::kExact);
    EXPECT_NEAR((ray.direction - rayOfNerfstudio(transform, 100, 120, 32, 24, p.x(), p.y())).norm(), 0, tolerance::kExact);
  }
}

TEST(Nerfstudio, ARoundedRotationKeepsTheCentreAndIsWarnedOf) {
  // cos and sin of 30 degrees with four digits: far from the origin, a centre that turned with the repair would move by 0.1.
  const std::string rounded = "[[0.8660,-0.5000,0,1000],[0.5000,0.8660,0,-2000],[0,0,1,500],[0,0,0,1]]";
  const Capture capture = readText(with(minimalTransforms(), kIdentityPose, rounded));
  const Camera& camera = capture.views.at(0).camera;
  EXPECT_NEAR((camera.centreInWorld() - Eigen::Vector3d(1000, -2000, 500)).norm(), 0, 1e-9);  // 1e-12 of its size
  const Eigen::Matrix3d r = camera.camFromWorld.linear();
  EXPECT_NEAR((r * r.transpose() - Eigen::Matrix3d::Identity()).norm(), 0, tolerance::kExact);
  EXPECT_THAT(capture.warnings, ElementsAre("frames[0].transform_matrix: not exactly a rotation, replaced by the nearest one"));
}

TEST(Nerfstudio, ARotationInSinglePrecisionKeepsTheCentreSilently) {
  const float c = std::cos(0.4f), s = std::sin(0.4f);
  const nlohmann::json rows = {{c, -s, 0, 0.05}, {s, c, 0, 0.02}, {0, 0, 1, 0.01}, {0, 0, 0, 1}};
  const Capture capture = readText(with(minimalTransforms(), kIdentityPose, rows.dump()));
  const Camera& camera = capture.views.at(0).camera;
  EXPECT_THAT(capture.warnings, IsEmpty());
  const Eigen::Matrix3d r = camera.camFromWorld.linear();
  EXPECT_NEAR((r * r.transpose() - Eigen::Matrix3d::Identity()).norm(), 0, tolerance::kExact);
  EXPECT_NEAR((camera.centreInWorld() - Eigen::Vector3d(0.05, 0.02, 0.01)).norm(), 0, tolerance::kExact);
}

TEST(Nerfstudio, WarningsOfManyFramesAreCounted) {
  std::string frames;
  for (int i = 0; i < 30; ++i)
    frames += (i ? "," : "") + std::string(R"({"file_path": "i)") + std::to_string(i) +
              R"(.png", "weather": "rain", "transform_matrix": [[0.866,-0.5,0,0],[0.5,0.866,0,0],[0,0,1,0],[0,0,0,1]]})";
  const Capture capture = readText(R"({"w": 64, "h": 48, "fl_x": 100, "mood": 1, "frames": [)" + frames + "]}");
  EXPECT_EQ(capture.views.size(), 30u);
  EXPECT_THAT(capture.warnings,
              ElementsAre("frames[0].transform_matrix and 29 more: not exactly a rotation, replaced by the nearest one",
                          "mood: unknown key, ignored", "frames[0].weather and 29 more: unknown key, ignored"));
}

// ---- The original world -------------------------------------------------------------------------------------------------------

/// COLMAP's pose R = 90 degrees about z, t = (1, 2, 3), centre -R^T t = (-2, 1, -3), as nerfstudio converts it: the second and
/// the third column of the inverse times -1, rows in the order 0 2 1, the last of them times -1. What it does with the rows is
/// the applied_transform.
std::string convertedByNerfstudio(const std::string& keys = "") {
  return with(with(minimalTransforms(), kIdentityPose, "[[0,-1,0,-2],[0,0,-1,-3],[1,0,0,-1],[0,0,0,1]]"), "{",
              R"({"applied_transform": [[1,0,0,0],[0,0,1,0],[0,-1,0,0]],)" + keys);
}

TEST(Nerfstudio, AppliedTransformIsContainedAndNotAppliedAgain) {
  const Capture capture = readText(convertedByNerfstudio());
  EXPECT_NEAR((capture.views[0].camera.centreInWorld() - Eigen::Vector3d(-2, -3, -1)).norm(), 0, tolerance::kExact);
  EXPECT_THAT(capture.facts, Contains(HasSubstr("as stored; applied_transform is part of it")));
}

TEST(Nerfstudio, OriginalWorldIsColmapsPose) {
  const Camera camera = readText(convertedByNerfstudio(), originalWorld()).views.at(0).camera;
  Eigen::Matrix3d r;
  r << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  EXPECT_NEAR((camera.camFromWorld.linear() - r).norm(), 0, tolerance::kExact);
  EXPECT_NEAR((camera.camFromWorld.translation() - Eigen::Vector3d(1, 2, 3)).norm(), 0, tolerance::kExact);
}

TEST(Nerfstudio, OriginalWorldUndoesScaleAndShift) {
  // stored = 2 (A x + (10, 20, 30)) for the centre x = (-2, 1, -3): 2 ((-2, -3, -1) + (10, 20, 30)) = (16, 34, 58). As 4x4.
  std::string text = with(convertedByNerfstudio(R"("applied_scale": 2,)"), "[[1,0,0,0],[0,0,1,0],[0,-1,0,0]]",
                          "[[1,0,0,10],[0,0,1,20],[0,-1,0,30],[0,0,0,1]]");
  text = with(text, "[[0,-1,0,-2],[0,0,-1,-3],[1,0,0,-1],[0,0,0,1]]", "[[0,-1,0,16],[0,0,-1,34],[1,0,0,58],[0,0,0,1]]");
  const Capture capture = readText(text, originalWorld());
  EXPECT_NEAR((capture.views[0].camera.centreInWorld() - Eigen::Vector3d(-2, 1, -3)).norm(), 0, tolerance::kExact);
  EXPECT_NEAR((capture.views[0].camera.camFromWorld.translation() - Eigen::Vector3d(1, 2, 3)).norm(), 0, tolerance::kExact);
  EXPECT_THAT(capture.facts, Contains(HasSubstr("are undone (scale 2)")));
  // The same factor inside the matrix: 2 A.
  text = with(with(text, R"("applied_scale": 2,)", ""), "[[1,0,0,10],[0,0,1,20],[0,-1,0,30],[0,0,0,1]]",
              "[[2,0,0,20],[0,0,2,40],[0,-2,0,60]]");
  EXPECT_NEAR((readText(text, originalWorld()).views[0].camera.centreInWorld() - Eigen::Vector3d(-2, 1, -3)).norm(), 0,
              tolerance::kExact);
}

TEST(Nerfstudio, WhatCannotBeUndoneIsRefusedByName) {
  struct Row {
    const char* name;
    const char* matrix;
    const char* reason;
  };
  for (const Row& row :
       {Row{"mirror", "[[1,0,0,0],[0,1,0,0],[0,0,-1,0]]", "mirrors"},
        Row{"shear", "[[1,0.01,0,0],[0,1,0,0],[0,0,1,0]]", "shears"},
        Row{"stretch", "[[1,0,0,0],[0,1,0,0],[0,0,1.01,0]]", "shears"},
        Row{"flat", "[[1,0,0,0],[0,1,0,0],[0,0,0,0]]", "flattens"}, Row{"zero", "[[0,0,0,0],[0,0,0,0],[0,0,0,0]]", "flattens"}}) {
    const std::string text = with(convertedByNerfstudio(), "[[1,0,0,0],[0,0,1,0],[0,-1,0,0]]", row.matrix);
    EXPECT_THAT(inputErrorOf([&] { readText(text, originalWorld()); }),
                testing::AllOf(HasSubstr("applied_transform: "), HasSubstr(row.reason)))
        << row.name;
    EXPECT_NO_THROW(readText(text)) << row.name;  // stored is stored
  }
  EXPECT_THAT(inputErrorOf([] { readText(minimalTransforms(), originalWorld()); }), HasSubstr("nothing to undo"));
  CaptureOptions other;
  other.world = "Original";
  EXPECT_THAT(inputErrorOf([&] { readText(convertedByNerfstudio(), other); }),
              HasSubstr("--world Original: is not one of: original"));
}

TEST(Nerfstudio, ARoundedAppliedTransformIsRepairedWithAWarning) {
  const std::string text =
      with(convertedByNerfstudio(), "[[1,0,0,0],[0,0,1,0],[0,-1,0,0]]", "[[0.866,-0.5,0,0],[0.5,0.8661,0,0],[0,0,1,0]]");
  const Capture capture = readText(text, originalWorld());
  EXPECT_THAT(capture.warnings, ElementsAre(HasSubstr("applied_transform: not exactly a rotation")));
  const Eigen::Matrix3d r = capture.views[0].camera.camFromWorld.linear();
  EXPECT_NEAR((r * r.transpose() - Eigen::Matrix3d::Identity()).norm(), 0, tolerance::kExact);
}

// ---- Intrinsics ---------------------------------------------------------------------------------------------------------------

TEST(Nerfstudio, LensesByTheirNames) {
  struct Row {
    const char* keys;
    LensModel model;
    std::array<double, 8> parameters;
  };
  const char* const all = R"("k1": 0.1, "k2": 0.2, "k3": 0.3, "p1": 0.01, "p2": 0.02)";
  for (const Row& row :
       {Row{R"("camera_model": "SIMPLE_PINHOLE")", LensModel::OpenCv, {}},
        Row{R"("camera_model": "PINHOLE", "k1": 0, "k4": 0.0, "p1": 0)", LensModel::OpenCv, {}},
        Row{R"("camera_model": "SIMPLE_RADIAL", "k1": 0.1)", LensModel::SimpleRadial, {0.1}},
        Row{R"("camera_model": "RADIAL", "k1": 0.1, "k2": 0.2)", LensModel::Radial, {0.1, 0.2}},
        // Our order is COLMAP's: the tangential terms stand before k3.
        Row{R"("camera_model": "OPENCV", "k1": 0.1, "k2": 0.2, "k3": 0.3, "p1": 0.01, "p2": 0.02)",
            LensModel::OpenCv,
            {0.1, 0.2, 0.01, 0.02, 0.3}},
        Row{all, LensModel::OpenCv, {0.1, 0.2, 0.01, 0.02, 0.3}},
        Row{R"("is_fisheye": false, "k1": 0.1)", LensModel::OpenCv, {0.1}},
        Row{R"("camera_model": "OPENCV_FISHEYE", "k1": 0.1, "k2": 0.2, "k3": 0.3, "k4": 0.4)",
            LensModel::OpenCvFisheye,
            {0.1, 0.2, 0.3, 0.4}},
        Row{R"("camera_model": "OPENCV_FISHEYE")", LensModel::OpenCvFisheye, {}},
        Row{R"("is_fisheye": true, "k1": 0.1, "k4": 0.4, "p1": 0)", LensModel::OpenCvFisheye, {0.1, 0, 0, 0.4}}}) {
    const Camera camera = cameraOf(with(minimalTransforms(), "{", "{" + std::string(row.keys) + ","));
    EXPECT_EQ(camera.lens.model, row.model) << row.keys;
    EXPECT_EQ(camera.lens.parameters, row.parameters) << row.keys;
    // The same in the frame.
    const Camera own = cameraOf(with(minimalTransforms(), R"("file_path")", std::string(row.keys) + R"(, "file_path")"));
    EXPECT_EQ(own.lens, camera.lens) << row.keys;
  }
}

TEST(Nerfstudio, IntrinsicsOfAFrame) {
  const std::string text = R"({"camera_model": "OPENCV", "fl_x": 100, "frames": [
    {"file_path": "b.png", "w": 64, "h": 48, "fl_x": 100.0, "cx": 30, "cy": 20, "k1": 0.1, "transform_matrix": )" +
                           std::string(kIdentityPose) + R"(},
    {"file_path": "a.png", "w": 32, "h": 16, "fl_y": 90, "cx": 10, "cy": 8, "transform_matrix": )" +
                           kIdentityPose + "}]}";
  const Capture capture = readText(text);
  ASSERT_EQ(capture.views.size(), 2u);
  const Camera &a = capture.views[0].camera, &b = capture.views[1].camera;  // by name
  EXPECT_EQ(capture.views[0].name, "a.png");
  EXPECT_EQ(a.width, 32);
  EXPECT_EQ(a.pixelFromRay(0, 0), 100);
  EXPECT_EQ(a.pixelFromRay(1, 1), 90);
  EXPECT_EQ(a.pixelFromRay(0, 2), 9.5);
  EXPECT_TRUE(a.lens.isIdeal());
  EXPECT_EQ(b.pixelFromRay(1, 1), 100);  // fl_y missing: square pixels
  EXPECT_EQ(b.pixelFromRay(1, 2), 19.5);
  EXPECT_EQ(b.lens.parameters[0], 0.1);
}

TEST(Nerfstudio, AngleOfViewGivesTheFocalLength) {
  // 90 degrees over 64 px: 32 / tan 45 = 32. 60 degrees over 48 px: 24 / tan 30 = 24 sqrt 3.
  const std::string frames = R"("frames": [{"file_path": "a.png", "transform_matrix": )" + std::string(kIdentityPose) + "}]}";
  const Capture one = readText(R"({"w": 64, "h": 48, "camera_angle_x": 1.5707963267948966, )" + frames);
  EXPECT_NEAR(one.views[0].camera.pixelFromRay(0, 0), 32, tolerance::kExact);
  EXPECT_NEAR(one.views[0].camera.pixelFromRay(1, 1), 32, tolerance::kExact);
  EXPECT_EQ(one.views[0].camera.pixelFromRay(0, 2), 31.5);  // the middle of the image
  EXPECT_EQ(one.views[0].camera.pixelFromRay(1, 2), 23.5);
  EXPECT_THAT(one.facts, Contains(HasSubstr("focal length: from the angle of view for 1 frame")));
  const Camera two =
      cameraOf(R"({"w": 64, "h": 48, "camera_angle_x": 1.5707963267948966, "camera_angle_y": 1.0471975511965976, )" + frames);
  EXPECT_NEAR(two.pixelFromRay(0, 0), 32, tolerance::kExact);
  EXPECT_NEAR(two.pixelFromRay(1, 1), 41.569219381653056, tolerance::kExact);
  const Camera degrees = cameraOf(R"({"w": 64, "h": 48, "x_fov": 90, "y_fov": 60, )" + frames);
  EXPECT_NEAR(degrees.pixelFromRay(0, 0), 32, tolerance::kExact);
  EXPECT_NEAR(degrees.pixelFromRay(1, 1), 41.569219381653056, tolerance::kExact);
}

TEST(Nerfstudio, AnAngleSaysNothingOfAFisheye) {
  // 2 atan(24 / 50): a pinhole's fl_y would be 50.
  const Capture capture =
      readText(with(minimalTransforms(), R"("fl_y": 120)", R"("camera_angle_y": 0.8949, "camera_model": "OPENCV_FISHEYE")"));
  EXPECT_EQ(capture.views[0].camera.pixelFromRay(1, 1), 100);
  EXPECT_THAT(capture.warnings, IsEmpty());
}

TEST(Nerfstudio, FocalLengthCountsMoreThanTheAngleWhichIsWarnedOf) {
  // 2 atan(32 / 100) = 0.6194... belongs to fl_x = 100; 0.7 would be 87.7.
  const Capture same = readText(with(minimalTransforms(), "{", R"({"camera_angle_x": 0.61940598,)"));
  EXPECT_THAT(same.warnings, IsEmpty());
  const Capture other = readText(with(minimalTransforms(), "{", R"({"camera_angle_x": 0.7,)"));
  EXPECT_EQ(other.views[0].camera.pixelFromRay(0, 0), 100);
  EXPECT_THAT(other.warnings, ElementsAre(HasSubstr("the angle of view says another focal length")));
}

TEST(Nerfstudio, SizeOfTheImageWhereTheFileHasNone) {
  const TemporaryFolder folder;
  const std::string text = with(minimalTransforms(), R"("w": 64, "h": 48, )", "");
  EXPECT_THAT(inputErrorOf([&] { readText(folder, text); }), HasSubstr("frames[0]: does not say the size of its image"));
  folder.write("images/a.png", picture(40, 30));
  const Capture capture = readText(folder, text);
  EXPECT_EQ(capture.views[0].camera.width, 40);
  EXPECT_EQ(capture.views[0].camera.height, 30);
  EXPECT_THAT(inputErrorOf([&] { readText(folder, with(text, "{", R"({"h": 31,)")); }),
              HasSubstr("h: differs from the size of the image, 30"));
  EXPECT_EQ(readText(folder, with(text, "{", R"({"w": 40,)")).views[0].camera.height, 30);
}

struct BadCase {
  const char* name;
  const char* from;
  const char* to;
  const char* place;
  const char* reason;
};
class BadTransforms : public testing::TestWithParam<BadCase> {};

TEST_P(BadTransforms, IsOneLineWithFilePlaceAndReason) {
  const TemporaryFolder folder;
  const fs::path file = folder.write("transforms.json", with(minimalTransforms(), GetParam().from, GetParam().to));
  const std::string message = inputErrorOf([&] { nerfstudioReader().read(file, {}); });
  EXPECT_THAT(message, HasSubstr(file.string() + ": " + GetParam().place)) << GetParam().name;
  EXPECT_THAT(message, HasSubstr(GetParam().reason)) << GetParam().name;
}

INSTANTIATE_TEST_SUITE_P(
    Nerfstudio, BadTransforms,
    testing::Values(
        BadCase{"syntax", "\"frames\": [", "\"frames\": [,", "line 2, column ", "not valid JSON"},
        BadCase{"no frames", "\"frames\"", "\"farmes\"", "frames: ", "missing"},
        BadCase{"frames of a wrong type", "\"frames\": [{", "\"frames\": 3, \"old\": [{", "frames: ", "must be a list"},
        BadCase{"no frame", "\"frames\": [{", "\"frames\": [], \"old\": [{", "frames: ", "empty"},
        BadCase{"frame of a wrong type", "\"frames\": [{", "\"frames\": [7, {", "frames[0]: ", "must be an object"},
        BadCase{"scene of ours", "{\"w\"", "{\"glint_scene\": 1, \"w\"", "", "is a scene of ours"},
        BadCase{"no path", "\"file_path\"", "\"file_paht\"", "frames[0].file_path: ", "missing"},
        BadCase{"empty path", "images/a.png", "", "frames[0].file_path: ", "empty"},
        BadCase{"path out of the folder", "images/a.png", "../a.png", "frames[0].file_path: ", "leaves the folder"},
        BadCase{"absolute path", "images/a.png", "/etc/hostname", "frames[0].file_path: ", "absolute"},
        BadCase{"depth out of the folder", "\"file_path\"", "\"depth_file_path\": \"../d.png\", \"file_path\"",
                "frames[0].depth_file_path: ", "leaves the folder"},
        BadCase{"mask out of the folder", "\"file_path\"", "\"mask_path\": \"../d.png\", \"file_path\"",
                "frames[0].mask_path: ", "leaves the folder"},
        BadCase{"no pose", "\"transform_matrix\"", "\"transform\"", "frames[0].transform_matrix: ", "missing"},
        BadCase{"pose of three rows", ",[0,0,0,1]]", "]", "frames[0].transform_matrix: ", "4 rows"},
        BadCase{"pose with a word", "[0,1,0,2]", "[0,\"x\",0,2]", "frames[0].transform_matrix[1][1]: ", "finite"},
        BadCase{"only a pose with a NaN", "[0,1,0,2]", "[0,NaN,0,2]", "frames: ", "have no finite pose"},
        BadCase{"only a pose of zeros", "[[1,0,0,1],[0,1,0,2],[0,0,1,3]", "[[0,0,0,0],[0,0,0,0],[0,0,0,0]",
                "frames: ", "have no finite pose"},
        BadCase{"pose far away", "[0,1,0,2]", "[0,1,0,1e300]", "frames[0].transform_matrix[1][3]: ", "larger than 1e15"},
        BadCase{"pose mirrored", "[0,1,0,2]", "[0,-1,0,2]", "frames[0].transform_matrix: ", "mirrored"},
        BadCase{"pose scaled", "[[1,0,0,1],[0,1,0,2],[0,0,1,3]", "[[2,0,0,1],[0,2,0,2],[0,0,2,3]",
                "frames[0].transform_matrix: ", "not a rotation"},
        BadCase{"no focal length", "\"fl_x\": 100, ", "", "frames[0].fl_x: ", "missing, and so is camera_angle_x"},
        BadCase{"zero focal length", "\"fl_x\": 100", "\"fl_x\": 0", "fl_x: ", "positive"},
        BadCase{"negative focal length", "\"fl_y\": 120", "\"fl_y\": -120", "fl_y: ", "positive"},
        BadCase{"huge focal length", "\"fl_y\": 120", "\"fl_y\": 1e200", "fl_y: ", "larger than"},
        BadCase{"angle of half a turn", "\"fl_x\": 100", "\"camera_angle_x\": 3.2", "camera_angle_x: ", "between 0 and 180"},
        BadCase{"angle of nothing", "\"fl_x\": 100", "\"camera_angle_x\": 0", "camera_angle_x: ", "between 0 and 180"},
        BadCase{"angle of next to nothing", "\"fl_x\": 100", "\"camera_angle_x\": 1e-300", "frames[0]: ", "larger than"},
        BadCase{"half a pixel", "\"w\": 64", "\"w\": 64.5", "w: ", "whole number"},
        BadCase{"no width", "\"w\": 64", "\"w\": 0", "frames[0]: ", "1 .. 65536"},
        BadCase{"huge image", "\"w\": 64, \"h\": 48", "\"w\": 65536, \"h\": 65536", "frames[0]: ", "image.megapixels"},
        BadCase{"principal point far away", "\"cx\": 32", "\"cx\": 1e20", "frames[0]: ", "larger than"},
        BadCase{"intrinsics as text", "\"cx\": 32", "\"cx\": \"32\"", "cx: ", "must be a finite number"},
        BadCase{"unknown model", "{\"w\"", "{\"camera_model\": \"EQUIRECTANGULAR\", \"w\"",
                "camera_model: ", "'EQUIRECTANGULAR' is not supported"},
        BadCase{"model in lower case", "{\"w\"", "{\"camera_model\": \"opencv\", \"w\"", "camera_model: ", "'opencv'"},
        BadCase{"model as number", "{\"w\"", "{\"camera_model\": 4, \"w\"", "camera_model: ", "must be text"},
        BadCase{"two models", "{\"w\"", "{\"camera_model\": \"OPENCV\", \"is_fisheye\": true, \"k1\": 1, \"w\"",
                "is_fisheye: ", "contradicts the camera_model OPENCV"},
        BadCase{"fourth radial term", "{\"w\"", "{\"camera_model\": \"OPENCV\", \"k4\": 1e-9, \"w\"", "k4: ", "OPENCV has no k4"},
        BadCase{"fourth radial term without model", "{\"w\"", "{\"k4\": 0.1, \"w\"", "k4: ", "OPENCV has no k4"},
        BadCase{"pinhole with a term", "{\"w\"", "{\"camera_model\": \"PINHOLE\", \"k1\": 0.1, \"w\"",
                "k1: ", "PINHOLE has no k1"},
        BadCase{"simple radial with two terms", "{\"w\"", "{\"camera_model\": \"SIMPLE_RADIAL\", \"k2\": 0.1, \"w\"",
                "k2: ", "SIMPLE_RADIAL has no k2"},
        BadCase{"radial with tangential", "{\"w\"", "{\"camera_model\": \"RADIAL\", \"p2\": 0.1, \"w\"",
                "p2: ", "RADIAL has no p2"},
        BadCase{"fisheye with tangential", "{\"w\"", "{\"camera_model\": \"OPENCV_FISHEYE\", \"p1\": 0.1, \"w\"",
                "p1: ", "OPENCV_FISHEYE has no p1"},
        BadCase{"fisheye by flag alone", "{\"w\"", "{\"is_fisheye\": true, \"w\"", "is_fisheye: ", "name the camera_model"},
        BadCase{"fisheye by angle", "\"fl_x\": 100", "\"camera_angle_x\": 1, \"camera_model\": \"OPENCV_FISHEYE\"",
                "frames[0].fl_x: ", "does not give the focal length of a fisheye"},
        BadCase{"term as null", "{\"w\"", "{\"k1\": null, \"w\"", "k1: ", "must be a finite number"},
        BadCase{"huge term", "{\"w\"", "{\"k1\": 1e20, \"w\"", "k1: ", "larger than"},
        BadCase{"other terms", "{\"w\"", "{\"distortion_params\": [0,0,0.1], \"w\"",
                "distortion_params: ", "would change the geometry"},
        BadCase{"rolling shutter", "{\"w\"", "{\"rolling_shutter\": [0,0,0.1,0], \"w\"",
                "rolling_shutter: ", "would change the geometry"},
        BadCase{"other axes", "{\"w\"", "{\"from_na\": true, \"w\"", "from_na: ", "would change the geometry"},
        BadCase{"moving camera", "\"file_path\"", "\"transform_matrix_end\": [[1]], \"file_path\"",
                "frames[0].transform_matrix_end: ", "would change the geometry"},
        BadCase{"applied transform of two rows", "{\"w\"", "{\"applied_transform\": [[1,0,0,0],[0,1,0,0]], \"w\"",
                "applied_transform: ", "3 or 4 rows"},
        BadCase{"applied transform of a short row", "{\"w\"", "{\"applied_transform\": [[1,0,0,0],[0,1,0,0],[0,0,1]], \"w\"",
                "applied_transform[2]: ", "4 numbers, has 3"},
        BadCase{"projective applied transform", "{\"w\"",
                "{\"applied_transform\": [[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,1,1]], \"w\"", "applied_transform: ", "last row"},
        BadCase{"applied scale of nothing", "{\"w\"", "{\"applied_scale\": 0, \"w\"", "applied_scale: ", "positive"},
        BadCase{"depth unit of nothing", "\"frames\": [{",
                "\"depth_unit_scale_factor\": 0, \"frames\": [{\"depth_file_path\": \"d.png\", ",
                "depth_unit_scale_factor: ", "positive"}),
    [](const auto& info) {
      std::string name = info.param.name;
      for (char& c : name)
        if (c == ' ') c = '_';
      return name;
    });

TEST(Nerfstudio, KeysThatOthersWriteAreNoWarning) {
  const std::string text = with(
      with(minimalTransforms(), "{",
           R"({"train_filenames": ["images/a.png"], "val_filenames": [], "test_filenames": [], "orientation_override": "none",
      "aabb_scale": 16, "skew": 0, "rolling_shutter": [0, 0, 0, 0], "is_fisheye": false, "k3": 0, "k4": 0, "from_na": false,)"),
      R"("file_path")", R"("colmap_im_id": 3, "sharpness": 20.5, "rotation": 0.0125, "time": 0.5, "file_path")");
  EXPECT_THAT(readText(text).warnings, IsEmpty());
}

TEST(Nerfstudio, PlacementOfInstantNgpIsWarnedOfAndNotApplied) {
  const Capture capture = readText(with(minimalTransforms(), "{", R"({"scale": 0.33, "offset": [0.5, 0.5, 0.5],)"));
  EXPECT_THAT(capture.warnings, ElementsAre(HasSubstr("scale, offset: place the world in the unit cube of instant-ngp")));
  EXPECT_EQ(capture.views[0].camera.centreInWorld(), Eigen::Vector3d(1, 2, 3));
}

// ---- Files --------------------------------------------------------------------------------------------------------------------

TEST(Nerfstudio, ViewsAreOrderedByNameWithAbsolutePaths) {
  const TemporaryFolder folder;
  const std::string pose = kIdentityPose;
  const Capture capture = readText(folder, R"({"w": 64, "h": 48, "fl_x": 100, "frames": [
    {"file_path": "./images/b.png", "mask_path": "masks/b.png", "transform_matrix": )" +
                                               pose + R"(},
    {"file_path": "images\\a.png", "depth_file_path": null, "transform_matrix": )" +
                                               pose + "}]}");
  EXPECT_EQ(capture.kind, "nerfstudio");
  EXPECT_EQ(capture.folder, folder.path());
  EXPECT_EQ(capture.file, folder / "transforms.json");
  EXPECT_THAT(capture.sources, ElementsAre(folder / "transforms.json"));
  EXPECT_FALSE(capture.hasScale);
  ASSERT_EQ(capture.views.size(), 2u);
  EXPECT_EQ(capture.views[0].name, "images/a.png");
  EXPECT_EQ(capture.views[1].name, "images/b.png");
  EXPECT_EQ(capture.views[1].image, folder / "images/b.png");
  EXPECT_EQ(capture.views[1].mask, folder / "masks/b.png");
  EXPECT_TRUE(capture.views[0].mask.empty());
  EXPECT_TRUE(capture.views[0].depth.empty());
  EXPECT_EQ(capture.views[0].depthScale, 0);
  EXPECT_TRUE(nerfstudioReader().tracks(capture, {}).empty());
}

TEST(Nerfstudio, TwoImagesOfOneNameAreRefused) {
  const std::string pose = kIdentityPose;
  EXPECT_THAT(inputErrorOf([&] {
                readText(R"({"w": 64, "h": 48, "fl_x": 100, "frames": [{"file_path": "a.png", "transform_matrix": )" + pose +
                         R"(}, {"file_path": "./a.png", "fl_x": 90, "transform_matrix": )" + pose + "}]}");
              }),
              HasSubstr("two images are called 'a.png'"));
}

TEST(Nerfstudio, ImagesWithoutEndingAreFound) {
  const std::string text = with(minimalTransforms(), "images/a.png", "./train/r_0");
  for (const char* ending : {".png", ".jpg", ".jpeg"}) {
    const TemporaryFolder folder;
    folder.write(std::string("train/r_0") + ending, picture(64, 48));
    const Capture capture = readText(folder, text);
    EXPECT_EQ(capture.views[0].name, "train/r_0");
    EXPECT_EQ(capture.views[0].image, folder / ("train/r_0" + std::string(ending)));
  }
  const TemporaryFolder dotted;  // what follows a dot need not be an ending
  dotted.write("IMG.0001.jpg", picture(64, 48));
  EXPECT_EQ(readText(dotted, with(minimalTransforms(), "images/a.png", "IMG.0001")).views[0].image, dotted / "IMG.0001.jpg");
  const TemporaryFolder elsewhere;  // the place of the photographs that a person names
  elsewhere.write("r_0.png", picture(64, 48));
  CaptureOptions options;
  options.photographs = {elsewhere.path()};
  EXPECT_EQ(readText(text, options).views[0].image, elsewhere / "r_0.png");
  const TemporaryFolder none;
  EXPECT_EQ(readText(none, text).views[0].image, none / "train/r_0");
}

TEST(Nerfstudio, DepthIsInMillimetresUnlessItIsFloatingPoint) {
  const auto scaleOf = [](const std::string& file, const std::string& keys = "", const CaptureOptions& options = {}) {
    const std::string text =
        with(convertedByNerfstudio(keys), R"("file_path")", R"("depth_file_path": ")" + file + R"(", "file_path")");
    return readText(text, options).views.at(0).depthScale;
  };
  EXPECT_EQ(scaleOf("depth/a.png"), 0.001);
  EXPECT_EQ(scaleOf("depth/a.exr"), 1);
  EXPECT_EQ(scaleOf("depth/a.TIFF"), 1);
  EXPECT_EQ(scaleOf("depth/a.tif"), 1);
  EXPECT_EQ(scaleOf("depth/a.png", R"("depth_unit_scale_factor": 0.0002,)"), 0.0002);
  // nerfstudio multiplies depths by applied_scale to come from the original world to the stored one.
  EXPECT_DOUBLE_EQ(scaleOf("depth/a.png", R"("applied_scale": 4,)"), 0.004);
  EXPECT_DOUBLE_EQ(scaleOf("depth/a.png", R"("applied_scale": 4,)", originalWorld()), 0.001);
  EXPECT_EQ(scaleOf("depth/a.npy"), 0);  // left out
}

TEST(Nerfstudio, DepthOfInstantNgpNeedsItsFactor) {
  const std::string text = with(minimalTransforms(), R"("file_path")", R"("depth_path": "d.png", "file_path")");
  const Capture without = readText(text);
  EXPECT_TRUE(without.views[0].depth.empty());
  const TemporaryFolder folder;
  const Capture capture = readText(folder, with(text, "{", R"({"integer_depth_scale": 0.25,)"));
  EXPECT_EQ(capture.views[0].depth, folder / "d.png");
  EXPECT_EQ(capture.views[0].depthScale, 0.25);
}

TEST(Nerfstudio, FactsSayWhatWasConverted) {
  const std::string text = with(with(convertedByNerfstudio(R"("ply_file_path": "sparse_pc.ply",)"), R"("file_path")",
                                     R"("depth_file_path": "d.png", "mask_path": "m.png", "file_path")"),
                                "{", R"({"camera_model": "OPENCV",)");
  const TemporaryFolder folder;
  folder.write("sparse_pc.ply", kTwoPoints);
  const Capture stored = readText(folder, text);
  EXPECT_THAT(stored.facts,
              testing::AllOf(Contains("nerfstudio: transforms.json with 1 frame, camera model OPENCV"),
                             Contains(HasSubstr("camera to world with y up")), Contains(HasSubstr("corner of the first pixel")),
                             Contains(HasSubstr("each 0.001 of the unit of the world, for 1 frame")),
                             Contains("masks: for 1 frame"), Contains(HasSubstr("point cloud: 'sparse_pc.ply'"))));
  EXPECT_THAT(stored.warnings, IsEmpty());
}

TEST(Nerfstudio, IsRecognisedByContent) {
  const TemporaryFolder folder;
  const fs::path file = folder.write("sub/transforms.json", minimalTransforms());
  EXPECT_EQ(nerfstudioReader().recognise(file), file);
  EXPECT_EQ(nerfstudioReader().recognise(folder / "sub"), file);
  EXPECT_EQ(nerfstudioReader().recognise(folder.path()), fs::path());  // in the folder itself only
  const fs::path other = folder.write("cameras.txt", minimalTransforms());
  EXPECT_EQ(nerfstudioReader().recognise(other), other);
  const fs::path damaged = folder.write("damaged.json", with(minimalTransforms(), "}]}", "}"));
  EXPECT_EQ(nerfstudioReader().recognise(damaged), damaged);
  EXPECT_THAT(inputErrorOf([&] { nerfstudioReader().read(damaged, {}); }), HasSubstr("not valid JSON"));
  const fs::path marked = folder.write("marked.json", "\xEF\xBB\xBF" + minimalTransforms());  // as Windows editors begin UTF-8
  EXPECT_EQ(nerfstudioReader().read(nerfstudioReader().recognise(marked), {}).views.size(), 1u);
  // An unknown key of a scene of ours may have any name.
  EXPECT_EQ(nerfstudioReader().recognise(folder.write("scene.json", with(minimalTransforms(), "{", R"({"glint_scene" : 1,)"))),
            fs::path());
  EXPECT_EQ(nerfstudioReader().recognise(folder.write("text.json", "\"frames transform_matrix\"")), fs::path());
  EXPECT_EQ(nerfstudioReader().recognise(folder.write("value.json", R"({"a": "frames", "b": "transform_matrix"})")), fs::path());
  EXPECT_EQ(nerfstudioReader().recognise(folder.write("list.json", "[" + minimalTransforms() + "]")), fs::path());
  EXPECT_EQ(nerfstudioReader().recognise(folder.write("empty.json", "")), fs::path());
  EXPECT_EQ(nerfstudioReader().recognise(folder.write("scene2.json", minimalScene())), fs::path());
  EXPECT_EQ(nerfstudioReader().recognise(folder / "nothing"), fs::path());
  EXPECT_EQ(nerfstudioReader().recognise("/dev/null"), fs::path());
  EXPECT_EQ(nerfstudioReader().recognise(""), fs::path());
}

TEST(Nerfstudio, TheFramesOwnIntrinsicsCount) {
  const Capture capture = readText(with(minimalTransforms(), "\"file_path\"", "\"fl_x\": 101, \"file_path\""));
  EXPECT_EQ(capture.views[0].camera.pixelFromRay(0, 0), 101);
  EXPECT_THAT(capture.warnings, Contains(HasSubstr("frames[0].fl_x: differs from the value at the top of the file")));
}

TEST(Nerfstudio, TheTrainingPartIsTakenAndTheOthersAreNamed) {
  const TemporaryFolder folder;
  const fs::path train = folder.write("transforms_train.json", minimalTransforms());
  EXPECT_EQ(nerfstudioReader().recognise(folder.path()), train);
  folder.write("transforms_test.json", minimalTransforms());
  EXPECT_EQ(nerfstudioReader().recognise(folder.path()), train);
  EXPECT_EQ(nerfstudioReader().recognise(train), train);
  const fs::path whole = folder.write("transforms.json", minimalTransforms());
  EXPECT_EQ(nerfstudioReader().recognise(folder.path()), whole);
}

TEST(Nerfstudio, DamagedFilesAreErrorsAndNothingElse) {
  const TemporaryFolder folder;
  const std::string whole = convertedByNerfstudio(R"("k1": 0.1, "applied_scale": 2, "camera_angle_x": 0.6,)");
  int refused = 0, read = 0;
  const auto tryText = [&](const std::string& text) {
    const fs::path file = folder.write("transforms.json", text);
    for (const CaptureOptions& options : {CaptureOptions{}, originalWorld()}) {
      try {
        const Capture capture = nerfstudioReader().read(file, options);
        ++read;
        for (const CaptureView& view : capture.views) {
          EXPECT_TRUE(view.camera.camFromWorld.matrix().allFinite()) << text;
          EXPECT_TRUE(view.camera.pixelFromRay.allFinite()) << text;
        }
      } catch (const InputError& e) {
        ++refused;
        EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos) << e.what();
      }
    }
  };
  for (std::size_t n = 0; n < whole.size(); n += 3) tryText(whole.substr(0, n));
  EXPECT_EQ(read, 0);  // no beginning of a file is a file
  for (const char* value : {"null", "-1", "0", "1e400", "1e-320", "1e308", "\"x\"", "[]", "{}", "true", "NaN"})
    for (std::size_t at = 0; at < whole.size(); ++at) {
      const bool begins = std::isdigit(static_cast<unsigned char>(whole[at])) && at > 0 &&
                          !std::isalnum(static_cast<unsigned char>(whole[at - 1])) && whole[at - 1] != '.' &&
                          whole[at - 1] != '-';
      if (!begins) continue;
      std::size_t end = at;
      while (end < whole.size() && (std::isdigit(static_cast<unsigned char>(whole[end])) || whole[end] == '.')) ++end;
      tryText(whole.substr(0, at) + value + whole.substr(end));
    }
  EXPECT_GT(read, 0);
  EXPECT_GT(refused, 500);
}

}  // namespace
}  // namespace glint::nerfstudio_tests
