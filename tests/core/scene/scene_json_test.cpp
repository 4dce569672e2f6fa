// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <iomanip>
#include <sstream>

#include "core/scene/scene.h"
#include "core/scene/scene_reader.h"
#include "tests/core/scene/scene_fixture.h"
#include "tests/shared_data.h"
#include "tests/tolerances.h"

namespace glint {
namespace {
using namespace testing_support;
using testing::ElementsAre;
using testing::HasSubstr;
namespace fs = std::filesystem;

TEST(ReadScene, MinimalFileWithItsDefaults) {
  const TemporaryFolder folder;
  const Scene scene = readScene(folder.write("scene.json", minimalScene()));
  ASSERT_EQ(scene.frames.size(), 1u);
  const Frame& f = scene.frames[0];
  EXPECT_EQ(f.id, "a");
  EXPECT_EQ(f.surface, "ball");  // the only one
  EXPECT_EQ(f.camera.width, 64);
  EXPECT_EQ(f.camera.pixelFromRay(0, 2), 31.5);
  EXPECT_FALSE(f.camera.hasDistortion());
  EXPECT_TRUE(f.image.empty());
  // The camera stands at z = -2 and looks along +z: the world's origin lies 2 m in front of it.
  EXPECT_EQ(f.camera.depth(Eigen::Vector3d::Zero()), 2.0);
  EXPECT_EQ(scene.surfaces.at("ball").analytic()->radius, 0.4);
  EXPECT_TRUE(scene.warnings.empty());
  EXPECT_TRUE(scene.unknownJson.empty());
}

const char* const kDepthCamera =
    R"("depth_camera": {"width": 32, "height": 24, "fx": 40, "fy": 41, "cx": 15.5, "cy": 11.5, "maker": "x",
  "camera_from_depth": [[1,0,0,0.025],[0,1,0,0],[0,0,1,0.5],[0,0,0,1]]}, )";

TEST(ReadScene, DepthCameraOfOneFrameOrOfAll) {
  const TemporaryFolder folder;
  const std::string depth = with(minimalScene(), "\"id\": \"a\",", "\"id\": \"a\", \"depth\": \"d.png\",");
  const std::string own = with(depth, "\"id\": \"a\",", std::string(kDepthCamera) + "\"id\": \"a\",");
  const std::string shared = with(depth, "{", std::string("{") + kDepthCamera);
  for (const std::string& text : {own, shared}) {
    const Scene scene = readScene(folder.write("scene.json", text));
    ASSERT_TRUE(scene.frames[0].depthCamera);
    const Camera& camera = *scene.frames[0].depthCamera;
    EXPECT_EQ(camera.width, 32);
    EXPECT_EQ(camera.pixelFromRay(1, 1), 41);
    // A point 1 m before the depth camera lies 1.5 m before the frame's and 25 mm to its right.
    EXPECT_NEAR((camera.camFromWorld * Eigen::Vector3d(0.025, 0, 1.5) - Eigen::Vector3d(0, 0, 1)).norm(), 0, 1e-12);
    // Written and read again it is the same, its unknown key too.
    writeScene(scene, folder.path() / "again.json");
    const Scene again = readScene(folder.path() / "again.json");
    EXPECT_TRUE(again.frames[0].depthCamera->camFromWorld.isApprox(camera.camFromWorld, 1e-12));
    EXPECT_EQ(again.frames[0].depthCamera->pixelFromRay, camera.pixelFromRay);
    EXPECT_THAT(again.unknownJson, HasSubstr("maker"));
  }
  EXPECT_FALSE(readScene(folder.write("scene.json", depth)).frames[0].depthCamera);
}

TEST(ReadScene, DepthCameraWithoutPlaceIsRefused) {
  const TemporaryFolder folder;
  for (const auto& [from, to, expected] :
       {std::array<const char*, 3>{"camera_from_depth", "depth_from_camera", "camera_from_depth"},
        std::array<const char*, 3>{"[0,0,1,0.5]", "[0,0,2,0.5]", "camera_from_depth"},
        std::array<const char*, 3>{"\"maker\"", "\"k1\"", "k1"}}) {
    try {
      (void)readScene(folder.write("scene.json", with(with(minimalScene(), "{", std::string("{") + kDepthCamera), from, to)));
      FAIL() << to;
    } catch (const InputError& e) {
      EXPECT_THAT(e.what(), HasSubstr("depth_camera"));
      EXPECT_THAT(e.what(), HasSubstr(expected));
    }
  }
}

TEST(ReadScene, FolderOpensItsSceneFile) {
  const TemporaryFolder folder;
  folder.write("scene.json", with(minimalScene(), "{", R"({"name": "right", )"));
  folder.write("another.json", with(minimalScene(), "{", R"({"name": "wrong", )"));
  EXPECT_EQ(readScene(folder.path()).name, "right");
}

TEST(ReadScene, IsRecognisedByContentNotByName) {
  const TemporaryFolder folder;
  EXPECT_EQ(readScene(folder.write("anything.txt", minimalScene())).frames.size(), 1u);
}

TEST(ReadScene, EverySequenceOfTheDataIsRead) {
  GLINT_NEEDS_SHARED_DATA();
  struct Row {
    const char* file;
    std::size_t frames, surfaces;
  };
  for (const Row& row :
       {Row{"plane_to_cylinder/scene.json", 60, 10}, Row{"plane_to_cylinder/scene-analytic.json", 60, 10},
        Row{"sphere/scene.json", 24, 1}, Row{"sphere/scene-analytic.json", 24, 1}, Row{"vase/scene.json", 40, 1}}) {
    const fs::path file = fs::path(GLINT_SHARED_DIR) / "data/cycles" / row.file;
    const Scene scene = readScene(file);
    EXPECT_EQ(scene.frames.size(), row.frames) << row.file;
    EXPECT_EQ(scene.surfaces.size(), row.surfaces) << row.file;
    EXPECT_THAT(scene.warnings, ElementsAre()) << row.file;
  }
}

TEST(ReadScene, DistortionIsRemovedFromGivenHighlights) {
  // k1 = 0.1 at f = 80: the ideal ray (0.2, 0) is measured at 0.2 (1 + 0.1 * 0.04) = 0.2008.
  const TemporaryFolder folder;
  std::string text = with(minimalScene(), "\"cy\": 23.5", "\"cy\": 23.5, \"distortion\": [0.1,0,0,0,0]");
  text = with(text, "\"id\": \"a\"", R"("id": "a", "highlights": [{"light": "lamp", "level": 0.5, "peak": [47.564, 23.5],
    "contour": [[47.564, 23.5], [48, 24], [48, 25], [47, 25], [46, 24]]}])");
  const Scene scene = readScene(folder.write("scene.json", text));
  const Highlight& h = scene.frames.at(0).highlights.at(0);
  EXPECT_NEAR(h.peak.x(), 31.5 + 80 * 0.2, tolerance::kPixel);
  EXPECT_NEAR(h.peak.y(), 23.5, tolerance::kPixel);
  EXPECT_NEAR(h.contour.points.at(0).x(), 31.5 + 80 * 0.2, tolerance::kPixel);
  EXPECT_TRUE(h.fromScene);
  EXPECT_FALSE(h.touchesBorder);
  EXPECT_GT(signedArea(h.contour), 0);
}

struct BadCase {
  const char* name;
  const char* from;
  const char* to;
  const char* place;
  const char* reason;
};
class BadScene : public testing::TestWithParam<BadCase> {};

TEST_P(BadScene, IsOneLineWithFilePlaceAndReason) {
  const TemporaryFolder folder;
  const fs::path file = folder.write("scene.json", with(minimalScene(), GetParam().from, GetParam().to));
  const std::string message = inputErrorOf([&] { readScene(file); });
  EXPECT_THAT(message, HasSubstr(file.string() + ": " + GetParam().place)) << GetParam().name;
  EXPECT_THAT(message, HasSubstr(GetParam().reason)) << GetParam().name;
}

INSTANTIATE_TEST_SUITE_P(
    ReadScene, BadScene,
    testing::Values(
        BadCase{"syntax", "\"frames\": [", "\"frames\": [,", "line 3, column ", "not valid JSON"},
        BadCase{"cut off", "\"radius\": 0.4}}}}", "\"radius\"", "line 4, column ", "not valid JSON"},
        BadCase{"other version", "\"glint_scene\": 1", "\"glint_scene\": 3", "glint_scene: ", "version 3"},
        BadCase{"pose of version 2", "\"id\": \"a\"",
                "\"id\": \"a\", \"world_from_object\": [[1,0,0,0],[0,1,0,0],[0,0,1,3],[0,0,0,1]]",
                "frames[0].world_from_object: ", "version 2"},
        BadCase{"object that is no pose", "\"id\": \"a\"", "\"id\": \"a\", \"world_from_object\": 1",
                "frames[0].world_from_object: ", "must be a list"},
        BadCase{"frame of version 2", "\"surfaces\"",
                "\"lights\": [{\"id\": \"l\", \"position\": [0, 0, 1], \"frame\": \"camera\"}], \"surfaces\"",
                "lights[0].frame: ", "version 2"},
        BadCase{"no such frame", "\"surfaces\"",
                "\"lights\": [{\"id\": \"l\", \"position\": [0, 0, 1], \"frame\": \"object\"}], \"surfaces\"",
                "lights[0].frame: ", "must be \"world\" or \"camera\""},
        BadCase{"known light of version 2", "\"surfaces\"",
                "\"lights\": [{\"id\": \"l\", \"position\": [0, 0, 1], \"known\": true}], \"surfaces\"",
                "lights[0].known: ", "version 2"},
        BadCase{"known as text", "\"surfaces\"",
                "\"lights\": [{\"id\": \"l\", \"position\": [0, 0, 1], \"known\": \"yes\"}], \"surfaces\"",
                "lights[0].known: ", "must be true or false"},
        BadCase{"uncertain without being known", "\"surfaces\"",
                "\"lights\": [{\"id\": \"l\", \"position\": [0, 0, 1], \"sigma_m\": 1}], \"surfaces\"",
                "lights[0].sigma_m: ", "belongs to a light that is known"},
        BadCase{"an angle of a place", "\"surfaces\"",
                "\"lights\": [{\"id\": \"l\", \"position\": [0, 0, 1], \"known\": true, \"sigma_deg\": 1}], \"surfaces\"",
                "lights[0].sigma_deg: ", "belongs to a direction"},
        BadCase{"a negative sigma", "\"surfaces\"",
                "\"lights\": [{\"id\": \"l\", \"position\": [0, 0, 1], \"known\": true, \"sigma_m\": -1}], \"surfaces\"",
                "lights[0].sigma_m: ", "must not be negative"},
        BadCase{"version of a wrong type", "\"glint_scene\": 1", "\"glint_scene\": \"1\"",
                "glint_scene: ", "must be a finite number, is text"},
        BadCase{"no frames key", "\"frames\"", "\"farmes\"", "frames: ", "missing"},
        BadCase{"frames of a wrong type", "\"frames\": [{", "\"frames\": 3, \"old\": [{",
                "frames: ", "must be a list, is a number"},
        BadCase{"no frame", "\"frames\": [{", "\"frames\": [], \"old\": [{", "frames: ", "empty"},
        BadCase{"no id", "\"id\": \"a\",", "", "frames[0].id: ", "missing"},
        BadCase{"empty id", "\"id\": \"a\"", "\"id\": \"\"", "frames[0].id: ", "empty"},
        BadCase{"ids twice", "\"frames\": [",
                R"("frames": [{"id": "a", "camera_from_world": [[1,0,0,0],[0,1,0,0],[0,0,1,2],[0,0,0,1]]},)",
                "frames[1].id: ", "duplicate id 'a'"},
        BadCase{"a surface twice", "\"surfaces\": {", "\"surfaces\": {\"ball\": {\"analytic\": {\"type\": \"plane\"}}, ",
                "surfaces.ball: ", "duplicate key"},
        BadCase{"a light twice", "\"surfaces\"",
                R"("lights": [{"id": "l", "position": [0,0,1]}, {"id": "l", "position": [0,0,2]}], "surfaces")",
                "lights[1].id: ", "duplicate id"},
        BadCase{"pose with a NaN", "[0,1,0,0]", "[0,NaN,0,0]", "frames[0].camera_from_world[1][1]: ", "finite"},
        BadCase{"pose with an infinity", "[0,0,1,2]", "[0,0,1,-Infinity]", "frames[0].camera_from_world[2][3]: ", "finite"},
        BadCase{"pose with a short row", "[0,1,0,0]", "[0,1,0]", "frames[0].camera_from_world[1]: ", "4 numbers, has 3"},
        BadCase{"pose mirrored", "[0,0,1,2]", "[0,0,-1,2]", "frames[0].camera_from_world: ", "mirrored"},
        BadCase{"pose scaled", "[[1,0,0,0],[0,1,0,0],[0,0,1,2]", "[[2,0,0,0],[0,2,0,0],[0,0,2,2]",
                "frames[0].camera_from_world: ", "not a rotation"},
        BadCase{"pose with a projective row", "[0,0,0,1]]", "[0,0,0,2]]", "frames[0].camera_from_world: ", "last row"},
        BadCase{"singular K", "\"fx\": 80", "\"fx\": 0", "camera.fx: ", "singular"},
        BadCase{"mirrored K", "\"fy\": 80", "\"fy\": -80", "camera.fy: ", "positive"},
        BadCase{"half a pixel", "\"width\": 64", "\"width\": 64.5", "camera.width: ", "whole number"},
        BadCase{"no width", "\"width\": 64", "\"width\": 0", "camera.width: ", "1 .. 65536"},
        BadCase{"no camera", "\"camera\":", "\"kamera\":", "frames[0].camera: ", "missing"},
        BadCase{"unknown surface", "\"id\": \"a\"", "\"id\": \"a\", \"surface\": \"box\"",
                "frames[0].surface: ", "surface 'box' does not exist"},
        BadCase{"no surface at all", "\"surfaces\"", "\"sufraces\"", "frames[0].surface: ", "no surface and the frame no depth"},
        BadCase{"unknown analytic type", "\"sphere\"", "\"cube\"", "surfaces.ball.analytic.type: ", "'cube' is not one of"},
        BadCase{"negative radius", "0.4", "-0.4", "surfaces.ball.analytic.radius: ", "positive"},
        BadCase{"number too large", "0.4", "1e999", "JSON: not valid JSON: ", "number overflow"},
        BadCase{"missing mesh", "\"analytic\": {\"type\": \"sphere\", \"radius\": 0.4}", "\"mesh\": \"body.ply\"",
                "surfaces.ball.mesh: ", "body.ply'"},
        BadCase{"path out of the folder", "\"id\": \"a\"", "\"id\": \"a\", \"image\": \"../x.png\"",
                "frames[0].image: ", "leaves the folder"},
        BadCase{"hidden way out", "\"id\": \"a\"", "\"id\": \"a\", \"image\": \"sub/../../x.png\"",
                "frames[0].image: ", "leaves the folder"},
        BadCase{"absolute path", "\"id\": \"a\"", "\"id\": \"a\", \"image\": \"/etc/hostname\"", "frames[0].image: ", "absolute"},
        BadCase{"image of a wrong type", "\"id\": \"a\"", "\"id\": \"a\", \"image\": 7",
                "frames[0].image: ", "must be text, is a number"},
        BadCase{"light without a place", "\"surfaces\"", R"("lights": [{"id": "l"}], "surfaces")",
                "lights[0]: ", "exactly one of"},
        BadCase{"other units", "\"camera\":", "\"units\": \"mm\", \"camera\":", "units: ", "'mm'"},
        BadCase{"short contour", "\"id\": \"a\"",
                "\"id\": \"a\", \"highlights\": [{\"peak\": [1,1], \"contour\": [[0,0],[1,0],[1,1]]}]",
                "frames[0].highlights[0].contour: ", "at least 5"}),
    [](const auto& info) {
      std::string name = info.param.name;
      for (char& c : name)
        if (c == ' ') c = '_';
      return name;
    });

TEST(ReadScene, LinkThatLeavesTheFolderIsRefusedUnlessAllowed) {
  const TemporaryFolder outside, folder;
  outside.write("x.png", "");
  fs::create_directory_symlink(outside.path(), folder / "link");
  const fs::path file =
      folder.write("scene.json", with(minimalScene(), "\"id\": \"a\"", "\"id\": \"a\", \"image\": \"link/x.png\""));
  EXPECT_THAT(inputErrorOf([&] { readScene(file); }), HasSubstr("frames[0].image: 'link/x.png' leaves the folder"));
  ReadOptions options;
  options.allowOutsidePaths = true;
  EXPECT_EQ(readScene(file, options).frames[0].image, folder / "link/x.png");
}

TEST(ReadScene, FolderReachedThroughALinkIsStillItsOwnFolder) {
  const TemporaryFolder real, other;
  real.write("scene.json", with(minimalScene(), "\"id\": \"a\"", "\"id\": \"a\", \"image\": \"x.png\""));
  fs::create_directory_symlink(real.path(), other / "link");
  EXPECT_NO_THROW(readScene(other / "link"));
}

TEST(ReadScene, WhatIsNotUnderstoodIsSaidWithAListOfWhatIs) {
  const TemporaryFolder folder;
  EXPECT_THAT(inputErrorOf([&] { readScene(folder.path()); }),
              testing::AllOf(HasSubstr("the folder is empty"), HasSubstr("scene file")));
  folder.write("readme.txt", "hello");
  EXPECT_THAT(inputErrorOf([&] { readScene(folder.path()); }), HasSubstr("nothing in this folder is recognised"));
  EXPECT_THAT(inputErrorOf([&] { readScene(folder.path()); }), testing::Not(HasSubstr("its folder")));
  EXPECT_THAT(inputErrorOf([&] { readScene(folder / "readme.txt"); }), HasSubstr("not recognised"));
  fs::create_directory(folder / "inside");
  folder.write("inside/scene.json", minimalScene());
  EXPECT_THAT(inputErrorOf([&] { readScene(folder.path()); }), HasSubstr("is recognised; its folder 'inside' is: scene file"));
  EXPECT_THAT(inputErrorOf([&] { readScene(folder / "nothing"); }), HasSubstr("no such file"));
  EXPECT_THAT(inputErrorOf([&] { readScene(folder.write("empty.json", "")); }), HasSubstr("the file is empty"));
}

TEST(ReadScene, WhatMovesIsReadAndWrittenAsVersion2) {
  const TemporaryFolder folder;
  std::string text = with(minimalScene(), "\"glint_scene\": 1", "\"glint_scene\": 2");
  text = with(text, "\"id\": \"a\"", "\"id\": \"a\", \"world_from_object\": [[0,-1,0,0.5],[1,0,0,0],[0,0,1,0],[0,0,0,1]]");
  text = with(text, "\"surfaces\"",
              "\"lights\": [{\"id\": \"flash\", \"position\": [0.05, 0, 0], \"frame\": \"camera\"}, {\"id\": \"sun\", "
              "\"direction\": [0, 0, 2], "
              "\"known\": true, \"sigma_deg\": 0.3}], \"surfaces\"");
  const Scene scene = readScene(folder.write("scene.json", text));
  EXPECT_TRUE(scene.warnings.empty());
  EXPECT_LT((scene.frames[0].worldFromObject * Eigen::Vector3d(1, 0, 0) - Eigen::Vector3d(0.5, 1, 0)).norm(), 1e-15);
  EXPECT_EQ(scene.lights[0].frame, LightFrame::Camera);
  // The camera stands 2 m before the origin: the flash lies beside it, by hand.
  EXPECT_LT((inWorld(scene.lights[0], scene.frames[0]).lamp.position() - Eigen::Vector3d(0.05, 0, -2)).norm(), 1e-15);
  writeScene(scene, folder / "again.json");
  EXPECT_THAT(contentOf(folder / "again.json"), HasSubstr("\"glint_scene\": 2"));
  const Scene again = readScene(folder / "again.json");
  EXPECT_EQ(again.frames[0].worldFromObject.matrix(), scene.frames[0].worldFromObject.matrix());
  EXPECT_EQ(again.lights[0].frame, LightFrame::Camera);
  EXPECT_FALSE(again.lights[0].known);
  EXPECT_TRUE(again.lights[1].known);
  EXPECT_EQ(again.lights[1].sigma, 0.3);
  EXPECT_EQ(inObject(again).frames[0].camera.camFromWorld.matrix(),
            (scene.frames[0].camera.camFromWorld * scene.frames[0].worldFromObject).matrix());
}

TEST(ReadScene, UnknownKeysAreWarnedOfAndKept) {
  const TemporaryFolder folder;
  std::string text = with(minimalScene(), "{\"glint_scene\"", "{\"flavour\": {\"a\": [1, null]}, \"glint_scene\"");
  text = with(text, "\"id\": \"a\"", "\"id\": \"a\", \"exposure\": 0.25");
  text = with(text, "\"radius\"", "\"colour\": \"red\", \"radius\"");
  const Scene scene = readScene(folder.write("scene.json", text));
  EXPECT_THAT(scene.warnings, ElementsAre("surfaces.ball.analytic.colour: unknown key, kept",
                                          "frames[0].exposure: unknown key, kept", "flavour: unknown key, kept"));
  writeScene(scene, folder / "again.json");
  const Scene again = readScene(folder / "again.json");
  EXPECT_EQ(again.unknownJson, scene.unknownJson);
  EXPECT_THAT(contentOf(folder / "again.json"),
              testing::AllOf(HasSubstr("\"exposure\": 0.25"), HasSubstr("\"colour\": \"red\""), HasSubstr("null")));
}

TEST(ReadScene, TheSignOfSynthIsKnownAndNotKept) {
  const TemporaryFolder folder;
  const auto madeBy = [&](const std::string& value) {
    return readScene(
        folder.write("scene.json", with(minimalScene(), "{\"glint_scene\"", "{\"made_by\": " + value + ", \"glint_scene\"")));
  };
  const Scene made = madeBy("\"glint synth\"");
  EXPECT_TRUE(made.warnings.empty());
  writeScene(made, folder / "copy.json");
  EXPECT_EQ(contentOf(folder / "copy.json").find("made_by"), std::string::npos);
  for (const char* other : {"\"a person\"", "3", "null"}) {
    const Scene scene = madeBy(other);
    EXPECT_THAT(scene.warnings, ElementsAre("made_by: unknown key, kept")) << other;
    writeScene(scene, folder / "copy.json");
    EXPECT_THAT(contentOf(folder / "copy.json"), HasSubstr("made_by")) << other;
  }
}

/// What nests as deep as a reader allows (100 levels) is written back, too.
TEST(ReadScene, AnUnknownKeyThatNestsAsDeepAsAllowedIsKept) {
  const TemporaryFolder folder;
  std::string deep = "1";
  for (int i = 0; i < 99; ++i) deep = "{\"a\":" + deep + "}";
  const Scene scene = readScene(
      folder.write("scene.json", with(minimalScene(), "{\"glint_scene\"", "{\"flavour\": " + deep + ", \"glint_scene\"")));
  writeScene(scene, folder / "again.json");
  EXPECT_EQ(readScene(folder / "again.json").unknownJson, scene.unknownJson);
}

// K = [80 2.5 31.5; 0 80 23.5; 0 0 1] at (0.2, -0.4, 2) of the camera: u = (80 * 0.2 + 2.5 * -0.4) / 2 + 31.5, v = 80 * -0.4 / 2
// + 23.5.
TEST(ReadScene, SkewIsPartOfTheCamera) {
  const TemporaryFolder folder;
  const auto sceneWith = [&](const std::string& more) {
    return readScene(folder.write("scene.json", with(minimalScene(), "\"cy\": 23.5", "\"cy\": 23.5, " + more)));
  };
  const Scene scene = sceneWith("\"skew\": 2.5");
  EXPECT_THAT(scene.warnings, ElementsAre());
  const Camera& camera = scene.frames[0].camera;
  const Eigen::Vector3d point(0.2, -0.4, 0);  // the camera stands at z = -2
  const Pixel expected(39, 7.5);
  ASSERT_TRUE(camera.project(point));
  EXPECT_LT((*camera.project(point) - expected).norm(), tolerance::kExact);
  EXPECT_LT((camera.projection().project(point) - expected).norm(), tolerance::kExact);
  EXPECT_LT(camera.ray(expected).direction.cross(Eigen::Vector3d(0.2, -0.4, 2).normalized()).norm(), tolerance::kExact);
  writeScene(scene, folder / "again.json");
  EXPECT_EQ(readScene(folder / "again.json").frames[0].camera.pixelFromRay, camera.pixelFromRay);
  // The lens bends normalised coordinates (0.1, -0.2): radial factor 1 + 0.2 * 0.05, then K.
  const Camera bent = sceneWith("\"skew\": 2.5, \"distortion\": [0.2, 0, 0, 0, 0]").frames[0].camera;
  const Pixel measured(80 * 0.101 + 2.5 * -0.202 + 31.5, 80 * -0.202 + 23.5);
  EXPECT_LT((bent.distorted(expected) - measured).norm(), tolerance::kPixel);
  EXPECT_LT((bent.undistorted(measured) - expected).norm(), tolerance::kPixel);
}

/// The minimal scene with more keys in its camera.
std::string withCamera(const std::string& more) { return with(minimalScene(), "\"cy\": 23.5", "\"cy\": 23.5, " + more); }

struct LensRow {
  const char* json;
  LensModel model;
  std::array<double, 8> parameters;
  const char* written;  ///< the numbers of "distortion"
};
class LensOfAScene : public testing::TestWithParam<LensRow> {};

TEST_P(LensOfAScene, IsReadAndWrittenBack) {
  const TemporaryFolder folder;
  const Scene scene = readScene(folder.write("scene.json", withCamera(GetParam().json)));
  // Some of these lenses bend so much that the border of the picture is beyond any ideal one.
  EXPECT_THAT(scene.warnings, testing::Each(HasSubstr("the lens sees more")));
  const Lens expected{GetParam().model, GetParam().parameters};
  EXPECT_EQ(scene.frames[0].camera.lens, expected);
  writeScene(scene, folder / "again.json");
  EXPECT_EQ(readScene(folder / "again.json").frames[0].camera.lens, expected);
  std::string text = contentOf(folder / "again.json");
  text.erase(std::remove_if(text.begin(), text.end(), [](unsigned char c) { return std::isspace(c); }), text.end());
  EXPECT_THAT(text, HasSubstr("\"distortion\":[" + std::string(GetParam().written) + "]"));
  // Scenes with the default model are written as before there were others.
  EXPECT_EQ(text.find("\"model\"") == std::string::npos, GetParam().model == LensModel::OpenCv);
}

INSTANTIATE_TEST_SUITE_P(
    ReadScene, LensOfAScene,
    testing::Values(
        LensRow{R"("skew": 0)", LensModel::OpenCv, {}, "0.0,0.0,0.0,0.0,0.0"},
        LensRow{R"("distortion": [1,2,3,4])", LensModel::OpenCv, {1, 2, 3, 4}, "1.0,2.0,3.0,4.0,0.0"},
        LensRow{R"("model": "OPENCV", "distortion": [1,2,3,4,5])", LensModel::OpenCv, {1, 2, 3, 4, 5}, "1.0,2.0,3.0,4.0,5.0"},
        LensRow{R"("model": "FULL_OPENCV", "distortion": [1,2,3,4,5,6,7,8])",
                LensModel::FullOpenCv,
                {1, 2, 3, 4, 5, 6, 7, 8},
                "1.0,2.0,3.0,4.0,5.0,6.0,7.0,8.0"},
        LensRow{R"("model": "SIMPLE_RADIAL", "distortion": [0.5])", LensModel::SimpleRadial, {0.5}, "0.5"},
        LensRow{R"("model": "RADIAL", "distortion": [0.5, 2])", LensModel::Radial, {0.5, 2}, "0.5,2.0"},
        LensRow{
            R"("model": "OPENCV_FISHEYE", "distortion": [1,2,3,4])", LensModel::OpenCvFisheye, {1, 2, 3, 4}, "1.0,2.0,3.0,4.0"},
        LensRow{R"("model": "OPENCV_FISHEYE")", LensModel::OpenCvFisheye, {}, "0.0,0.0,0.0,0.0"},
        LensRow{R"("model": "SIMPLE_RADIAL_FISHEYE", "distortion": [0.5])", LensModel::SimpleRadialFisheye, {0.5}, "0.5"},
        LensRow{R"("model": "RADIAL_FISHEYE", "distortion": [0.5, 2])", LensModel::RadialFisheye, {0.5, 2}, "0.5,2.0"},
        LensRow{R"("model": "FOV", "distortion": [-3.14])", LensModel::Fov, {-3.14}, "-3.14"},
        LensRow{R"("model": "THIN_PRISM_FISHEYE", "distortion": [1,2,3,4,5,6,7,8])",
                LensModel::ThinPrismFisheye,
                {1, 2, 3, 4, 5, 6, 7, 8},
                "1.0,2.0,3.0,4.0,5.0,6.0,7.0,8.0"},
        LensRow{R"("model": "VISUALSFM", "distortion": [0.5])", LensModel::VisualSfm, {0.5}, "0.5"}));

TEST(ReadScene, ALensIsRefusedWithWhatItNeeds) {
  const TemporaryFolder folder;
  const auto error = [&](const std::string& more) {
    return inputErrorOf([&] { readScene(folder.write("scene.json", withCamera(more))); });
  };
  EXPECT_THAT(
      error(R"("model": "FISHEYE")"),
      HasSubstr("camera.model: 'FISHEYE' is not supported, only OPENCV, FULL_OPENCV, SIMPLE_RADIAL, RADIAL, OPENCV_FISHEYE, "
                "SIMPLE_RADIAL_FISHEYE, RADIAL_FISHEYE, FOV, THIN_PRISM_FISHEYE, VISUALSFM"));
  EXPECT_THAT(error(R"("model": "opencv")"), HasSubstr("camera.model: 'opencv' is not supported"));
  EXPECT_THAT(error(R"("model": null)"), HasSubstr("camera.model: must be text"));
  EXPECT_THAT(error(R"("distortion": [1,2,3])"), HasSubstr("camera.distortion: must have 5 numbers (k1 k2 p1 p2 k3), has 3"));
  EXPECT_THAT(error(R"("distortion": [1,2,3,4,5,6])"), HasSubstr("must have 5 numbers (k1 k2 p1 p2 k3), has 6"));
  EXPECT_THAT(error(R"("model": "OPENCV_FISHEYE", "distortion": [1,2,3,4,5])"),
              HasSubstr("camera.distortion: must have 4 numbers (k1 k2 k3 k4), has 5"));
  EXPECT_THAT(error(R"("model": "FULL_OPENCV", "distortion": [1,2,3,4])"),
              HasSubstr("must have 8 numbers (k1 k2 p1 p2 k3 k4 k5 k6), has 4"));
  EXPECT_THAT(error(R"("model": "SIMPLE_RADIAL", "distortion": [])"), HasSubstr("must have 1 number (k), has 0"));
  EXPECT_THAT(error(R"("model": "RADIAL", "distortion": [1, 1e16])"), HasSubstr("camera.distortion[1]: is larger than 1e15"));
  EXPECT_THAT(error(R"("model": "RADIAL", "distortion": [1, NaN])"), HasSubstr("camera.distortion[1]: "));
  EXPECT_THAT(error(R"("model": "FOV", "distortion": [3.2])"), HasSubstr("camera.distortion[0]: must be between -pi and pi"));
}

// f = 80: what an ideal fisheye measures 16 px from the centre is seen 0.2 rad from the axis, ideally 80 tan(0.2) = 16.2168028 px
// from the centre; 128 px are 1.6 rad, 91.67 degrees.
TEST(ReadScene, AFisheyesHighlightsBecomeIdealPixels) {
  const TemporaryFolder folder;
  const auto sceneWith = [&](const char* peak) {
    const std::string text = withCamera(R"("model": "OPENCV_FISHEYE")");
    return folder.write("scene.json", with(text, "\"id\": \"a\"",
                                           std::string(R"("id": "a", "highlights": [{"peak": )") + peak +
                                               R"(, "contour": [[47.5, 23.5], [48, 24], [48, 25], [47, 25], [46, 24]]}])"));
  };
  const Scene scene = readScene(sceneWith("[31.5, 7.5]"));
  const Highlight& h = scene.frames.at(0).highlights.at(0);
  EXPECT_LT((h.peak - Pixel(31.5, 23.5 - 16.2168028)).norm(), 1e-6);  // its digits
  EXPECT_LT((h.contour.points.at(0) - Pixel(31.5 + 16.2168028, 23.5)).norm(), 1e-6);
  EXPECT_THAT(inputErrorOf([&] { readScene(sceneWith("[159.5, 23.5]")); }),
              HasSubstr("frames[0].highlights[0].peak: lies where the lens distortion cannot be removed: is seen 91.67 degrees"));
}

TEST(ReadScene, UnknownKeysThatWouldChangeTheGeometryAreRefused) {
  const TemporaryFolder folder;
  struct Row {
    const char *from, *to, *place;
  };
  for (const Row& row : std::initializer_list<Row>{
           {"\"cy\": 23.5", "\"cy\": 23.5, \"k4\": 0.1", "camera.k4: "},
           {"\"cy\": 23.5", "\"cy\": 23.5, \"Fov\": 0.1", "camera.Fov: "},
           {"\"cy\": 23.5", "\"cy\": 23.5, \"model\": \"EQUIRECTANGULAR\"", "camera.model: 'EQUIRECTANGULAR' is not supported"},
           {"\"id\": \"a\"", "\"id\": \"a\", \"world_from_camera\": []", "frames[0].world_from_camera: "},
           {"{\"analytic\"", "{\"scale\": 2, \"analytic\"", "surfaces.ball.scale: "},
           {"{", "{\"coordinate_system\": \"y up\", ", "coordinate_system: "}}) {
    const std::string error =
        inputErrorOf([&] { readScene(folder.write("scene.json", with(minimalScene(), row.from, row.to))); });
    EXPECT_THAT(error, HasSubstr(row.place)) << row.to;
    EXPECT_THAT(error, HasSubstr("is not supported")) << row.to;
  }
  EXPECT_NO_THROW(
      readScene(folder.write("scene.json", with(minimalScene(), "\"cy\": 23.5", "\"cy\": 23.5, \"model\": \"OPENCV\""))));
}

TEST(ReadScene, RoundedRotationIsRepairedAndWarnedOf) {
  // cos 30 deg = 0.86603 to five digits.
  const TemporaryFolder folder;
  const Scene scene = readScene(
      folder.write("scene.json", with(minimalScene(), "[[1,0,0,0],[0,1,0,0]", "[[0.86603,-0.5,0,0],[0.5,0.86603,0,0]")));
  EXPECT_EQ(scene.warnings.size(), 1u);
  const Eigen::Matrix3d r = scene.frames[0].camera.camFromWorld.linear();
  EXPECT_LT((r.transpose() * r - Eigen::Matrix3d::Identity()).norm(), tolerance::kExact);
  EXPECT_NEAR(r(1, 0), 0.5, 1e-5);  // five digits were given
}

TEST(WriteScene, RoundTripIsExact) {
  GLINT_NEEDS_SHARED_DATA();
  const fs::path data = fs::path(GLINT_SHARED_DIR) / "data/cycles/sphere";
  const Scene scene = readScene(data);
  const TemporaryFolder folder;
  for (const char* name : {"frames", "radiance", "depth", "mesh"}) fs::create_directory_symlink(data / name, folder / name);
  Scene moved = scene;
  const auto move = [&](fs::path& p) {
    if (!p.empty()) p = folder.path() / p.lexically_relative(scene.folder);
  };
  for (Frame& f : moved.frames) {
    move(f.image);
    move(f.radiance);
    move(f.depth);
  }
  for (auto& [id, s] : moved.surfaces)
    if (s.file()) move(s.file()->file);
  writeScene(moved, folder / "scene.json");
  ReadOptions options;
  options.allowOutsidePaths = true;  // the folders are links
  const Scene again = readScene(folder / "scene.json", options);
  ASSERT_EQ(again.frames.size(), scene.frames.size());
  for (std::size_t i = 0; i < scene.frames.size(); ++i) {
    EXPECT_EQ(again.frames[i].camera.camFromWorld.matrix(), scene.frames[i].camera.camFromWorld.matrix());
    EXPECT_EQ(again.frames[i].camera.pixelFromRay, scene.frames[i].camera.pixelFromRay);
    EXPECT_EQ(again.frames[i].image, moved.frames[i].image);
    EXPECT_EQ(again.frames[i].lightsOn, scene.frames[i].lightsOn);
  }
  EXPECT_EQ(again.lights.at(0).lamp.position(), scene.lights.at(0).lamp.position());
  EXPECT_THAT(contentOf(folder / "scene.json"), testing::Not(HasSubstr(folder.path().string())));  // relative paths only
}

TEST(WriteScene, EveryKindOfSurfaceLightAndHighlightComesBack) {
  const TemporaryFolder folder;
  const std::string text = R"({"glint_scene": 1, "name": "all",
    "frames": [{"id": "a", "camera": {"width": 64, "height": 48, "fx": 80, "fy": 81, "cx": 31.5, "cy": 23.5,
      "distortion": [0.1,-0.02,0.001,0.002,0.003]},
      "depth": "d.png", "depth_scale": 0.0002, "mask": "m.png", "normals": "n.tiff", "lights_on": ["p"],
      "camera_from_world": [[1,0,0,0],[0,1,0,0],[0,0,1,2],[0,0,0,1]],
      "highlights": [{"light": "p", "level": 0.2, "peak": [30.25, 20.5],
      "contour": [[28, 18], [32, 18.5], [33, 22], [30, 23], [27.5, 21]]}]},
      {"id": "b", "camera": {"width": 32, "height": 48, "fx": 80, "fy": 80, "cx": 15.5, "cy": 23.5}, "surface": "q",
      "camera_from_world": [[0,-1,0,0.5],[1,0,0,0],[0,0,1,2],[0,0,0,1]]}],
    "surfaces": {"p": {"analytic": {"type": "plane"}}, "c": {"analytic": {"type": "cylinder", "radius": 0.1}},
      "e": {"analytic": {"type": "ellipsoid", "semi_axes": [0.6, 0.35, 0.25],
      "world_from_surface": [[0,-1,0,0.5],[1,0,0,0],[0,0,1,2],[0,0,0,1]]}},
      "s": {"analytic": {"type": "sheet", "curvature": 0.5, "length": 1, "width": 2}},
      "t": {"analytic": {"type": "torus", "major_radius": 0.5, "minor_radius": 0.1}},
      "q": {"analytic": {"type": "quadric", "matrix": [[1,0,0,0],[0,2,0,0],[0,0,3,0],[0,0,0,-1]]}}},
    "lights": [{"id": "p", "position": [1, 0, 2], "radius": 0.02}, {"id": "sun", "direction": [0, 0, 2]},
      {"id": "tube", "segment": [[0, 0, 2], [0.6, 0, 2]], "radius": 0.015}]})";
  const Scene scene = readScene(folder.write("one.json", text));
  EXPECT_THAT(scene.warnings, ElementsAre());
  writeScene(scene, folder / "two.json");
  const Scene again = readScene(folder / "two.json");
  EXPECT_THAT(again.warnings, ElementsAre());
  EXPECT_EQ(Eigen::Vector3d(again.lights[1].lamp.centre.head<3>()), Eigen::Vector3d(0, 0, 1));
  EXPECT_EQ(endsOf(again.lights[2].lamp)->second, Eigen::Vector3d(0.6, 0, 2));
  EXPECT_EQ(again.surfaces.at("t").analytic()->minorRadius, 0.1);
  EXPECT_EQ(again.surfaces.at("s").analytic()->width, 2.0);
  EXPECT_EQ(again.surfaces.at("q").analytic()->matrix(2, 2), 3);
  EXPECT_EQ(again.surfaces.at("e").analytic()->worldFromSurface.matrix(),
            scene.surfaces.at("e").analytic()->worldFromSurface.matrix());
  EXPECT_EQ(again.frames[0].depthScale, 0.0002);
  EXPECT_EQ(again.frames[0].surface, "");
  EXPECT_EQ(again.frames[1].camera.width, 32);
  ASSERT_EQ(again.frames[0].highlights.size(), 1u);
  for (std::size_t i = 0; i < 5; ++i)
    EXPECT_LT((again.frames[0].highlights[0].contour.points[i] - scene.frames[0].highlights[0].contour.points[i]).norm(),
              tolerance::kPixel);
  writeScene(again, folder / "three.json");
  EXPECT_EQ(readScene(folder / "three.json").frames.size(), 2u);
}

/// Rotations are written with nine digits as often as with all of them. At 1e6 m the tenth digit is a millimetre: the camera must
/// stay where R c + t = 0 says, not where -R^T t does.
TEST(ReadSceneJson, ARotationOfNineDigitsKeepsItsCameraInPlace) {
  const Eigen::Vector3d centre(1e6, -6e5, 3e5);
  Eigen::Matrix3d r = (Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, -1).normalized())).toRotationMatrix();
  r = (r * 1e9).array().round() / 1e9;
  const Eigen::Vector3d t = -(r * centre);
  std::ostringstream pose;
  pose << std::setprecision(17) << "[[";
  for (int i = 0; i < 3; ++i) pose << r(i, 0) << "," << r(i, 1) << "," << r(i, 2) << "," << t(i) << "],[";
  pose << "0,0,0,1]]";
  const TemporaryFolder folder;
  const Scene scene =
      readScene(folder.write("scene.json", with(minimalScene(), "[[1,0,0,0],[0,1,0,0],[0,0,1,2],[0,0,0,1]]", pose.str())));
  const Eigen::Isometry3d& read = scene.frames[0].camera.camFromWorld;
  EXPECT_LT((scene.frames[0].camera.centreInWorld() - centre).norm(), 1e-8);
  EXPECT_LT((read.linear() * read.linear().transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-14);
  EXPECT_TRUE(scene.warnings.empty());
}

}  // namespace
}  // namespace glint
