// SPDX-License-Identifier: BSD-3-Clause
// Shading of a matt surface, against Lambert's law on a plane in closed form.
#include "core/retexture/shading.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/surface/analytic.h"

namespace glint::shading_tests {

/// A camera above the plane z = 0 that looks straight down; lengths times `scale`.
struct PlaneScene {
  Camera camera;
  std::shared_ptr<const Surface> surface;
  Eigen::Vector3d lamp;
  Image linear, highlight;
  std::vector<char> usable;

  static constexpr double kAmbient = 0.05, kLambert = 0.4;
  explicit PlaneScene(double scale = 1) : lamp(0.4 * scale, -0.3 * scale, 1.1 * scale) {
    camera.pixelFromRay << 60, 0, 39.5, 0, 60, 29.5, 0, 0, 1;
    camera.width = 80;
    camera.height = 60;
    camera.camFromWorld.linear() = Eigen::Vector3d(1, -1, -1).asDiagonal();
    camera.camFromWorld.translation() = Eigen::Vector3d(0, 0, 2 * scale);
    AnalyticSpec plane;
    plane.type = "plane";
    surface = makeAnalytic(plane);
    linear = Image(80, 60, 3);
    highlight = Image(80, 60, 3);
    usable.assign(80 * 60, 1);
    for (int y = 0; y < 60; ++y)
      for (int x = 0; x < 80; ++x)
        for (int c = 0; c < 3; ++c) linear.at(x, y, c) = float(truth(x, y, scale));
  }
  /// In closed form: N.L / r^2 = h / |L - P|^3 over the plane, 1 in the unit of scale.
  double truth(int x, int y, double scale) const {
    const Eigen::Vector3d p((x - 39.5) / 60 * 2 * scale, -(y - 29.5) / 60 * 2 * scale, 0);
    return kAmbient + kLambert * scale * scale * lamp.z() / std::pow((lamp - p).norm(), 3);
  }
  Outcome<LambertShading> fit(const std::vector<Light>& lights) const {
    return fitLambert(*surface, camera, lights, {linear, highlight, usable});
  }
  double worst(const LambertShading& s, double scale = 1) const {
    double most = 0;
    for (int y = 0; y < 60; ++y)
      for (int x = 0; x < 80; ++x) most = std::max(most, std::abs(s.shade.at(x, y) / truth(x, y, scale) - 1));
    return most;
  }
};

TEST(FitLambert, Nominal) {
  const PlaneScene scene;
  const Outcome<LambertShading> s = scene.fit({Light::at(scene.lamp)});
  ASSERT_TRUE(s) << s.failure().message();
  EXPECT_NEAR(s->ambient, PlaneScene::kAmbient, 1e-5);
  EXPECT_LT(scene.worst(*s), 1e-5);  // images are single precision
  EXPECT_LT(s->relativeRms, 1e-5);
}

TEST(FitLambert, Scale) {
  for (const double scale : {1e-3, 1e3}) {
    const PlaneScene scene(scale);
    const Outcome<LambertShading> s = scene.fit({Light::at(scene.lamp)});
    ASSERT_TRUE(s) << s.failure().message();
    EXPECT_LT(scene.worst(*s, scale), 1e-5) << scale;
  }
}

TEST(FitLambert, Noise) {
  PlaneScene scene;
  std::mt19937 random(7);
  std::normal_distribution<float> error(0, 0.01f);
  for (float& v : scene.linear.data) v += error(random);
  const Outcome<LambertShading> s = scene.fit({Light::at(scene.lamp)});
  ASSERT_TRUE(s);
  EXPECT_LT(scene.worst(*s), 0.01);  // 4800 pixels of 0.0058 about a mean of 0.2
  EXPECT_GT(s->relativeRms, 0.01);
}

TEST(FitLambert, AHighlightDoesNotCount) {
  PlaneScene scene;
  for (int y = 0; y < 60; ++y)  // over most of the frame, where robust weights alone would be misled
    for (int x = 12; x < 80; ++x)
      for (int c = 0; c < 3; ++c) {
        scene.highlight.at(x, y, c) = 0.05f;  // taken off exactly
        scene.linear.at(x, y, c) += 0.05f;
      }
  for (int y = 5; y < 12; ++y)
    for (int x = 5; x < 15; ++x)
      for (int c = 0; c < 3; ++c) scene.linear.at(x, y, c) += 2;  // of which the model knows nothing
  const Outcome<LambertShading> s = scene.fit({Light::at(scene.lamp)});
  ASSERT_TRUE(s);
  EXPECT_LT(scene.worst(*s), 1e-3);
}

TEST(FitLambert, Degenerate) {
  PlaneScene scene;
  const std::vector<Light> lamp{Light::at(scene.lamp)};
  // A light under the plane lights nothing: what is left is one ambient value, and the fit says how far off that is.
  const Outcome<LambertShading> dark = scene.fit({Light::at({0, 0, -1})});
  ASSERT_TRUE(dark);
  EXPECT_NEAR(dark->shade.at(0, 0), dark->shade.at(40, 30), 1e-6);
  EXPECT_GT(dark->relativeRms, 0.1);
  // Two lights in one place cannot be told apart; their sum can.
  const Outcome<LambertShading> twice = scene.fit({lamp[0], lamp[0]});
  ASSERT_TRUE(twice);
  EXPECT_LT(scene.worst(*twice), 1e-4);
  // No light darkens the surface.
  for (float& v : scene.linear.data) v = 0.5f - v;
  const Outcome<LambertShading> inverse = scene.fit(lamp);
  ASSERT_TRUE(inverse);
  EXPECT_EQ(inverse->byLight[0], 0);
  scene.usable.assign(scene.usable.size(), 0);
  ASSERT_FALSE(scene.fit(lamp));
  EXPECT_EQ(scene.fit(lamp).failure().reason, Reason::TooFewPoints);
  scene.camera.camFromWorld.linear() = Eigen::Matrix3d::Identity();  // looks up, away from the plane
  scene.camera.camFromWorld.translation() = Eigen::Vector3d(0, 0, -2);
  ASSERT_FALSE(scene.fit(lamp));
  EXPECT_EQ(scene.fit(lamp).failure().reason, Reason::NoSurface);
}

}  // namespace glint::shading_tests
