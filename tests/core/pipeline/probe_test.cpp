// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/probe.h"

#include <gtest/gtest.h>

#include <cmath>

namespace glint {
namespace {

LightEstimate estimateOf(const Light& light) {
  LightEstimate estimate;
  estimate.light = light;
  return estimate;
}

/// A unit sphere at the origin, seen from (0, 0, -3) along +z, focal length 100 px; the light where the camera is.
Inspection ballInFront() {
  auto scene = std::make_shared<Scene>();
  Frame frame;
  frame.id = "0";
  frame.surface = "ball";
  frame.camera.pixelFromRay << 100, 0, 50, 0, 100, 40, 0, 0, 1;
  frame.camera.camFromWorld = Eigen::Translation3d(0, 0, 3);
  frame.camera.width = 101;
  frame.camera.height = 81;
  scene->frames = {frame};
  AnalyticSpec ball;
  ball.type = "sphere";
  ball.radius = 1;
  scene->surfaces["ball"] = ball;
  Inspection inspection;
  inspection.scene = scene;
  inspection.surfaces = std::make_shared<const SurfaceCache>(*scene);
  inspection.lights.insert_or_assign({"lamp"}, estimateOf(Light::at({0, 0, -3})));
  inspection.lights.insert_or_assign({"behind"}, estimateOf(Light::towards({0, 0, 1})));
  inspection.lights.insert_or_assign({"lamp", "elsewhere"}, estimateOf(Light::at({5, 0, 0})));
  return inspection;
}

TEST(ProbePixel, ASphereInClosedForm) {
  const Inspection inspection = ballInFront();
  const Outcome<PixelProbe> middle = probePixel(inspection, 0, {50, 40});
  ASSERT_TRUE(middle);
  EXPECT_NEAR(middle->depth, 2, 1e-9);
  EXPECT_LT((middle->point.normal - Eigen::Vector3d(0, 0, -1)).norm(), 1e-9);
  ASSERT_EQ(middle->lights.size(), 2u);
  EXPECT_EQ(middle->lights[0].light, "behind");
  EXPECT_FALSE(middle->lights[0].alpha);
  EXPECT_NEAR(*middle->lights[1].alpha, 0, 1e-9);
  // A ray at the angle a from the axis meets the sphere at distance s = 3 cos a - sqrt(1 - 9 sin^2 a). The light is at the eye,
  // so H = V and alpha is the angle there between the ray and the radius: sin alpha = 3 sin a.
  const double a = std::atan(0.2), s = 3 * std::cos(a) - std::sqrt(1 - 9 * std::sin(a) * std::sin(a));
  const Outcome<PixelProbe> aside = probePixel(inspection, 0, {70, 40});
  ASSERT_TRUE(aside);
  EXPECT_NEAR(aside->depth, s * std::cos(a), 1e-9);
  EXPECT_NEAR(std::sin(*aside->lights[1].alpha), 3 * std::sin(a), 1e-9);
}

TEST(ProbePixel, TakesThePixelAsTheLensMeasuredIt) {
  Inspection inspection = ballInFront();
  const Outcome<PixelProbe> ideal = probePixel(inspection, 0, {70, 40});
  auto scene = std::make_shared<Scene>(*inspection.scene);
  scene->frames[0].camera.lens.parameters[0] = 0.5;  // k1: the ideal 0.2 is measured at 0.2 (1 + 0.5 * 0.2^2) = 0.204
  inspection.scene = scene;
  const Outcome<PixelProbe> measured = probePixel(inspection, 0, {70.4, 40});
  ASSERT_TRUE(ideal && measured);
  EXPECT_LT((measured->point.position - ideal->point.position).norm(), 1e-9);
}

TEST(ProbePixel, TheNormalIsThatOfTheCamerasSide) {
  Inspection inspection = ballInFront();
  auto scene = std::make_shared<Scene>(*inspection.scene);
  scene->frames[0].camera.camFromWorld = Eigen::Isometry3d::Identity();  // inside the ball, at its centre
  inspection.scene = scene;
  inspection.lights.insert_or_assign({"lamp"}, estimateOf(Light::at({0, 0, 0.5})));
  const Outcome<PixelProbe> probe = probePixel(inspection, 0, {50, 40});
  ASSERT_TRUE(probe);
  EXPECT_LT((probe->point.normal - Eigen::Vector3d(0, 0, -1)).norm(), 1e-9);
  EXPECT_NEAR(*probe->lights[1].alpha, 0, 1e-9);
}

TEST(ProbePixel, Degenerate) {
  Inspection inspection = ballInFront();
  EXPECT_EQ(probePixel(inspection, 0, {0, 0}).failure().reason, Reason::NoHit);
  EXPECT_THROW((void)probePixel(inspection, 1, {0, 0}), std::invalid_argument);
  inspection.surfaces.reset();
  EXPECT_EQ(probePixel(inspection, 0, {50, 40}).failure().reason, Reason::NoSurface);
}

}  // namespace
}  // namespace glint
