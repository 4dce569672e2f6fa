// SPDX-License-Identifier: BSD-3-Clause
// Corrections of scenes against poses and places that were worked out by hand. tests/formats/fixes.py has the whole way.
#include "core/scene/correction.h"

#include <gtest/gtest.h>

#include "core/base/number_text.h"
#include "tests/core/scene/scene_fixture.h"

namespace glint::correction_tests {
using testing_support::inputErrorOf;
using testing_support::minimalScene;
using testing_support::TemporaryFolder;

/// A quarter turn about z and a step along it: world to camera.
Scene sceneWithPose(const TemporaryFolder& folder, const std::string& frameKeys = "") {
  return readScene(folder.write("scene.json", R"({"glint_scene": 1,
  "camera": {"width": 64, "height": 48, "fx": 80, "fy": 90, "cx": 31.5, "cy": 23.5, "skew": 0.5, "distortion": [0.1, 0, 0, 0, 0]},
  "frames": [{"id": "a", )" + frameKeys +
                                                  R"("camera_from_world": [[0,-1,0,1],[1,0,0,2],[0,0,1,4],[0,0,0,1]]}],
  "surfaces": {"ball": {"analytic": {"type": "sphere", "radius": 0.4}}}})"));
}

Eigen::Matrix4d matrix(std::initializer_list<double> rows) {
  return Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(rows.begin());
}

TEST(Corrections, PosesByHand) {
  const TemporaryFolder folder;
  const Scene scene = sceneWithPose(folder);
  const auto poseAfter = [&](const char* fix) { return corrected(scene, fix).frames[0].camera.camFromWorld.matrix(); };
  // R^T and -R^T t.
  EXPECT_TRUE(poseAfter("invert-poses").isApprox(matrix({0, 1, 0, -2, -1, 0, 0, 1, 0, 0, 1, -4, 0, 0, 0, 1})));
  // The second and third row change their signs.
  EXPECT_TRUE(poseAfter("turn-axes").isApprox(matrix({0, -1, 0, 1, -1, 0, 0, -2, 0, 0, -1, -4, 0, 0, 0, 1})));
  EXPECT_TRUE(poseAfter("invert-poses-and-turn-axes").isApprox(matrix({0, 1, 0, -2, 1, 0, 0, -1, 0, 0, -1, 4, 0, 0, 0, 1})));
  EXPECT_TRUE(poseAfter("poses-mm").isApprox(matrix({0, -1, 0, 0.001, 1, 0, 0, 0.002, 0, 0, 1, 0.004, 0, 0, 0, 1})));
}

TEST(Corrections, IntrinsicsLeaveMeasuredHighlightsInPlace) {
  const TemporaryFolder folder;
  const Scene scene = sceneWithPose(
      folder,
      R"("highlights": [{"level": 0.5, "peak": [40, 30], "contour": [[38, 28], [42, 28], [42, 32], [40, 33], [38, 32]]}], )");
  const Scene moved = corrected(scene, "principal-point=-0.5"), longer = corrected(scene, "focal-length=1.1");
  EXPECT_DOUBLE_EQ(moved.frames[0].camera.pixelFromRay(0, 2), 31);
  EXPECT_DOUBLE_EQ(moved.frames[0].camera.pixelFromRay(1, 2), 23);
  EXPECT_DOUBLE_EQ(longer.frames[0].camera.pixelFromRay(0, 0), 88);
  EXPECT_DOUBLE_EQ(longer.frames[0].camera.pixelFromRay(1, 1), 99);
  EXPECT_DOUBLE_EQ(longer.frames[0].camera.pixelFromRay(0, 1), 0.55);
  for (const Scene* changed : {&moved, &longer}) {
    const Frame& f = changed->frames[0];
    const Highlight& h = f.highlights.at(0);
    EXPECT_LT((f.camera.distorted(h.peak) - Pixel(40, 30)).norm(), 1e-9);
    EXPECT_LT((f.camera.distorted(h.contour.points.at(2)) - Pixel(42, 32)).norm(), 1e-9);
  }
}

TEST(Corrections, UnitsOfMeshAndDepth) {
  const TemporaryFolder folder;
  folder.write("body.ply",
               "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty double y\nproperty double z\n"
               "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  Scene scene = readScene(folder.write("scene.json", R"({"glint_scene": 1,
  "camera": {"width": 64, "height": 48, "fx": 80, "fy": 80, "cx": 31.5, "cy": 23.5},
  "frames": [{"id": "a", "surface": "body", "camera_from_world": [[1,0,0,0],[0,1,0,0],[0,0,1,2],[0,0,0,1]]}],
  "surfaces": {"body": {"mesh": "body.ply", "units": "cm"}}})"));
  EXPECT_DOUBLE_EQ(corrected(scene, "mesh-mm").surfaces.at("body").file()->metresPerUnit, 1e-5);  // on top of what the file says
  EXPECT_NE(inputErrorOf([&] { corrected(scene, "depth-scale=0.001"); }).find("no frame has an integer depth map"),
            std::string::npos);
  scene.frames[0].depthScale = 0.005;
  EXPECT_DOUBLE_EQ(corrected(scene, "depth-scale=0.001").frames[0].depthScale, 0.001);
}

/// A mesh, a frame with an integer depth map and a lamp. The numbers are worked out by hand.
Scene sceneWithMesh(const TemporaryFolder& folder, const std::string& frameKeys) {
  folder.write("body.ply",
               "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty double y\nproperty double z\n"
               "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  return readScene(folder.write("scene.json", R"({"glint_scene": 1,
  "camera": {"width": 64, "height": 48, "fx": 80, "fy": 80, "cx": 31.5, "cy": 23.5},
  "frames": [{"id": "a", "surface": "body", )" + frameKeys +
                                                  R"( "camera_from_world": [[0,-1,0,1],[1,0,0,2],[0,0,1,4],[0,0,0,1]]}],
  "surfaces": {"body": {"mesh": "body.ply"}},
  "lights": [{"id": "lamp", "position": [5, 6, 11], "radius": 0.2}, {"id": "sun", "direction": [0, 0, 1]}]})"));
}

TEST(Corrections, CamerasMoveIntoTheFrameOfTheMesh) {
  const TemporaryFolder folder;
  Scene scene = sceneWithMesh(folder, "");
  scene.frames[0].depth = folder.path() / "depth.png";
  scene.frames[0].depthScale = 0.001;
  // World = 2 Q mesh + (1, 2, 3) with Q a quarter turn about x: y -> z, z -> -y. In the camera: R Q m + (R t + r) / 2 with
  // R t + r = (-2 + 1, 1 + 2, 3 + 4).
  const Scene moved = corrected(scene, "mesh-similarity=2,1.5707963267948966,0,0,1,2,3");
  EXPECT_TRUE(moved.frames[0].camera.camFromWorld.matrix().isApprox(
      matrix({0, 0, 1, -0.5, 1, 0, 0, 1.5, 0, 1, 0, 3.5, 0, 0, 0, 1}), 1e-12));
  EXPECT_DOUBLE_EQ(moved.frames[0].depthScale, 0.0005);
  // Q^T ((5, 6, 11) - t) / 2 = Q^T (2, 2, 4) = (2, 4, -2); the sun along z: (0, 1, 0).
  EXPECT_TRUE(moved.lights[0].lamp.position().isApprox(Eigen::Vector3d(2, 4, -2), 1e-12));
  EXPECT_DOUBLE_EQ(radiusOf(moved.lights[0].lamp), 0.1);
  EXPECT_TRUE(moved.lights[1].lamp.centre.head<3>().isApprox(Eigen::Vector3d(0, 1, 0), 1e-12));
  EXPECT_DOUBLE_EQ(moved.surfaces.at("body").file()->metresPerUnit, 1);
}

TEST(Corrections, ASimilarityComesBackFromItsText) {
  const TemporaryFolder folder;
  const Scene scene = sceneWithMesh(folder, "");
  Similarity s{1e-3, Eigen::AngleAxisd(2.5, Eigen::Vector3d(1, -2, 0.5).normalized()).toRotationMatrix(), {0.3, -40, 7}};
  const Scene moved = corrected(scene, meshSimilarityCorrection(s).fix);
  const Eigen::Isometry3d before = scene.frames[0].camera.camFromWorld, after = moved.frames[0].camera.camFromWorld;
  for (const Eigen::Vector3d& m : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(100, -20, 300)})  // the same line of sight
    EXPECT_TRUE((after * m).normalized().isApprox((before * (s * m)).normalized(), 1e-9));
}

TEST(Corrections, TheFrameOfTheMeshIsRefusedWhereFilesWouldHaveToChange) {
  const TemporaryFolder folder;
  const char* fix = "mesh-similarity=2,0,0,0,1,2,3";
  const auto refusal = [&](const Scene& scene) { return inputErrorOf([&] { corrected(scene, fix); }); };
  Scene scene = sceneWithMesh(folder, "");
  scene.frames[0].depth = folder.path() / "depth.tiff";
  EXPECT_NE(refusal(scene).find("floating point"), std::string::npos);
  scene = sceneWithMesh(folder, "");
  scene.frames[0].normals = folder.path() / "normals.tiff";
  EXPECT_NE(refusal(scene).find("normals"), std::string::npos);
  EXPECT_NE(refusal(sceneWithPose(folder)).find("no mesh"), std::string::npos);
  scene = sceneWithMesh(folder, "");
  scene.surfaces["other"] = scene.surfaces["body"];
  EXPECT_NE(refusal(scene).find("2 surfaces"), std::string::npos);
}

/// Stored pictures of 64 x 48 were turned: a point that was at (x, y) is seen at (47 - y, x), (63 - x, 47 - y) or (y, 63 - x).
TEST(Corrections, CamerasTurnWithThePictures) {
  const TemporaryFolder folder;
  const auto scene = [&](int width, int height) {
    return readScene(folder.write("scene.json", formatted(R"({"glint_scene": 1,
  "camera": {"width": %d, "height": %d, "fx": 80, "fy": 90, "cx": 30, "cy": 25, "distortion": [0.1, 0.02, 0.01, -0.02, 0]},
  "frames": [{"id": "a", "camera_from_world": [[0,-1,0,1],[1,0,0,2],[0,0,1,8],[0,0,0,1]]}],
  "surfaces": {"ball": {"analytic": {"type": "sphere", "radius": 0.4}}}})",
                                                          width, height)));
  };
  const auto pixelOf = [](const Scene& s, const Eigen::Vector3d& p) {
    const Camera& camera = s.frames[0].camera;
    return Pixel(camera.distorted(*camera.project(p)));
  };
  const Scene stored = scene(64, 48);
  for (const Eigen::Vector3d& p : {Eigen::Vector3d(0.3, -0.2, 0.1), Eigen::Vector3d(-1.5, 0.4, 0.9)}) {
    const Pixel was = pixelOf(stored, p);
    EXPECT_LT((pixelOf(corrected(scene(48, 64), "turn-cameras=90"), p) - Pixel(47 - was.y(), was.x())).norm(), 1e-9);
    EXPECT_LT((pixelOf(corrected(stored, "turn-cameras=180"), p) - Pixel(63 - was.x(), 47 - was.y())).norm(), 1e-9);
    EXPECT_LT((pixelOf(corrected(scene(48, 64), "turn-cameras=270"), p) - Pixel(was.y(), 63 - was.x())).norm(), 1e-9);
  }
}

TEST(Corrections, RefusesWhatItDoesNotKnow) {
  const TemporaryFolder folder;
  const Scene scene = sceneWithPose(folder);
  for (const char* fix : {"",
                          "invert",
                          "invert-poses=1",
                          "principal-point",
                          "principal-point=",
                          "principal-point=nan",
                          "focal-length=0",
                          "focal-length=-1",
                          "turn-cameras=45",
                          "turn-cameras=100",
                          "depth-scale=1e300",
                          "mesh-mm",
                          "mesh-similarity",
                          "mesh-similarity=",
                          "mesh-similarity=1,0,0,0,0,0",
                          "mesh-similarity=1,0,0,0,0,0,0,0",
                          "mesh-similarity=0,0,0,0,0,0,0",
                          "mesh-similarity=-1,0,0,0,0,0,0",
                          "mesh-similarity=1,9,0,0,0,0,0",
                          "mesh-similarity=1,0,0,0,nan,0,0",
                          "mesh-similarity=1,0,0,0,0,0,1e300"})
    EXPECT_NE(inputErrorOf([&] { corrected(scene, fix); }).find("--fix"), std::string::npos) << fix;
}

}  // namespace glint::correction_tests
