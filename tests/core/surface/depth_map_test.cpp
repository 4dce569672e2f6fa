// SPDX-License-Identifier: BSD-3-Clause
#include "core/surface/depth_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "tests/core/surface/surfaces.h"
#include "tests/shared_data.h"

namespace glint {
namespace {

using Eigen::Vector3d;

/// Depth of an analytic surface, ray by ray.
Image depthOf(const Surface& surface, const Camera& camera) {
  Image depth(camera.width, camera.height, 1);
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x)
      if (const Outcome<SurfacePoint> hit = surface.firstHit(camera.ray(camera.undistorted(Pixel(x, y)))))
        depth.at(x, y) = static_cast<float>(camera.depth(hit->position));
  return depth;
}

/// Worst distance and angle to the truth over the middle of the object.
void expectClose(const Surface& map, const Surface& truth, const Camera& camera, double metres, double degrees) {
  int tested = 0;
  for (int y = 0; y < camera.height; y += 7)
    for (int x = 0; x < camera.width; x += 7) {
      const Outcome<SurfacePoint> b = truth.firstHit(camera.ray(Pixel(x, y)));
      if (!b) continue;
      const double slant = facing(*b, camera.centreInWorld()).normal.dot((camera.centreInWorld() - b->position).normalized());
      if (slant < 0.6) continue;  // near the outline the neighbourhood is one-sided
      const Outcome<SurfacePoint> a = map.firstHit(camera.ray(Pixel(x, y)));
      ASSERT_TRUE(a) << x << " " << y;
      EXPECT_LT((a->position - b->position).norm(), metres);
      EXPECT_GT(a->normal.dot(camera.centreInWorld() - a->position), 0);
      EXPECT_LT(std::acos(std::min(1.0, std::abs(a->normal.dot(b->normal)))) * 180 / M_PI, degrees);
      ++tested;
    }
  EXPECT_GT(tested, 50);
}

TEST(DepthMap, SphereWithHolesAgreesWithTheAnalyticOne) {
  const auto sphere = makeAnalytic(test::sphere(0.4));
  const Camera camera = test::lookAt({0.2, -1.6, 0.5}, {0, 0, 0}, 200, 160, 120);
  Image depth = depthOf(*sphere, camera);
  for (int y = 58; y < 62; ++y)
    for (int x = 70; x < 75; ++x) depth.at(x, y) = x % 2 ? 0.f : std::nanf("");
  const auto map = makeDepthMap(depth, camera);
  ASSERT_TRUE(map) << map.failure().message();
  // 2 mm: the filled hole (Telea's extrapolation of a slanted surface); 1.5 degrees: plane fits over 3 cm near the rim.
  expectClose(**map, *sphere, camera, 2e-3, 1.5);
}

// The neighbourhood of a normal is a share of the depth, so that a scene in millimetres or kilometres is the same one.
TEST(DepthMap, Scale) {
  for (const double scale : {1e-6, 1e6}) {
    const auto sphere = makeAnalytic(test::sphere(0.4 * scale));
    const Camera camera = test::lookAt(scale * Vector3d(0.2, -1.6, 0.5), {0, 0, 0}, 200, 160, 120);
    const auto map = makeDepthMap(depthOf(*sphere, camera), camera);
    ASSERT_TRUE(map) << map.failure().message();
    // As at scale 1, without a hole: plane fits over 1.5 % of the depth near the rim.
    expectClose(**map, *sphere, camera, 5e-4 * scale, 1.5);
  }
}

TEST(DepthMap, LargeHolesAndJumpsStayOpen) {
  const auto sphere = makeAnalytic(test::sphere(0.4));
  const Camera camera = test::lookAt({0, -1.6, 0}, {0, 0, 0}, 200, 160, 120);
  Image depth = depthOf(*sphere, camera);
  for (int y = 40; y < 80; ++y)
    for (int x = 60; x < 100; ++x) depth.at(x, y) = 0;
  for (int y = 0; y < 120; ++y)
    for (int x = 0; x < 160; ++x)
      if (depth.at(x, y) == 0 && (x < 20 || x > 140)) depth.at(x, y) = 5;  // a wall far behind
  DepthMapOptions options;
  options.mesh.normals = NormalPolicy::Facet;
  const auto map = makeDepthMap(depth, camera, options);
  ASSERT_TRUE(map);
  EXPECT_FALSE((*map)->firstHit(camera.ray({80, 60})));
  const Outcome<SurfacePoint> wall = (*map)->firstHit(camera.ray({5.2, 60.3}));
  ASSERT_TRUE(wall);
  EXPECT_NEAR(camera.depth(wall->position), 5, 1e-5);
}

TEST(DepthMap, LensDistortionIsRemoved) {
  const auto sphere = makeAnalytic(test::sphere(0.4));
  Camera camera = test::lookAt({0, -1.6, 0.2}, {0, 0, 0}, 200, 160, 120);
  camera.lens.parameters = {-0.2, 0.05, 0.001, -0.001, 0};
  const auto map = makeDepthMap(depthOf(*sphere, camera), camera);
  ASSERT_TRUE(map);
  expectClose(**map, *sphere, camera, 1e-3, 1.5);
}

TEST(DepthMap, PathTracedSphereAgreesWithTheAnalyticOne) {
  GLINT_NEEDS_SHARED_DATA();
  const std::string folder = std::string(GLINT_SHARED_DIR) + "/data/cycles/sphere/";
  std::ifstream in(folder + "scene-analytic.json");
  const nlohmann::json scene = nlohmann::json::parse(in);
  const auto sphere = makeAnalytic(test::sphere(scene["surfaces"]["g00"]["analytic"]["radius"].get<double>()));
  for (const int frame : {0, 13}) {
    const nlohmann::json& f = scene["frames"][frame];
    Camera camera;
    camera.width = scene["camera"]["width"];
    camera.height = scene["camera"]["height"];
    camera.pixelFromRay << scene["camera"]["fx"].get<double>(), 0, scene["camera"]["cx"].get<double>(), 0,
        scene["camera"]["fy"].get<double>(), scene["camera"]["cy"].get<double>(), 0, 0, 1;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 4; ++j) camera.camFromWorld.matrix()(i, j) = f["camera_from_world"][i][j].get<double>();
    const cv::Mat image = cv::imread(folder + "depth/" + f["id"].get<std::string>() + ".tiff", cv::IMREAD_UNCHANGED);
    ASSERT_EQ(image.type(), CV_32FC1);
    Image depth(image.cols, image.rows, 1);
    for (int y = 0; y < image.rows; ++y)
      for (int x = 0; x < image.cols; ++x) depth.at(x, y) = image.at<float>(y, x);
    const auto map = makeDepthMap(depth, camera);
    ASSERT_TRUE(map) << map.failure().message();
    // The renderer's depth agrees with its geometry within 0.3 mm.
    expectClose(**map, *sphere, camera, 5e-4, 0.5);
  }
}

TEST(DepthMap, Degenerate) {
  const Camera camera = test::lookAt({0, -1.6, 0}, {0, 0, 0}, 200, 160, 120);
  EXPECT_EQ(makeDepthMap(Image(160, 120, 1, 0.f), camera).failure().reason, Reason::NoSurface);
  EXPECT_EQ(makeDepthMap(Image(160, 120, 1, std::nanf("")), camera).failure().reason, Reason::NoSurface);
  Image one(160, 120, 1);
  one.at(80, 60) = 1;
  EXPECT_EQ(makeDepthMap(one, camera).failure().reason, Reason::NoSurface);
  EXPECT_THROW((void)makeDepthMap(Image(10, 10, 1, 1.f), camera), std::invalid_argument);
  EXPECT_THROW((void)makeDepthMap(Image(160, 120, 3, 1.f), camera), std::invalid_argument);
}

}  // namespace
}  // namespace glint
