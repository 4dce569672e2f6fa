// SPDX-License-Identifier: BSD-3-Clause
#include "core/scene/convention_report.h"

#include <gtest/gtest.h>

namespace glint {
namespace {

/// Balls in a row, 3 m apart, each seen whole by two frames that come long after each other.
Scene rowOfBalls(int count) {
  Scene scene;
  for (int i = 0; i < count; ++i) {
    AnalyticSpec& ball = scene.surfaces[std::to_string(i)].analytic.emplace();
    ball.type = "sphere";
    ball.radius = 0.25;
    ball.worldFromSurface.translation().x() = 3 * i;
  }
  for (int i = 0; i < 2 * count; ++i) {
    Frame f;
    f.id = std::to_string(i);
    f.surface = std::to_string(i % count);
    f.camera.width = 640;
    f.camera.height = 480;
    f.camera.pixelFromRay << 800, 0, 319.5, 0, 800, 239.5, 0, 0, 1;
    f.camera.camFromWorld.translation() = Eigen::Vector3d(-3 * (i % count), 0, 2);
    scene.frames.push_back(f);
  }
  return scene;
}

// More surfaces than triangles are kept of: every frame is still compared with its own.
TEST(ConventionReport, FramesOfManySurfacesSeeTheirOwn) {
  constexpr int kCount = 150;
  const ConventionReport report = conventionReport(rowOfBalls(kCount));
  ASSERT_EQ(report.surfaces.size(), std::size_t(kCount));
  ASSERT_EQ(report.frames.size(), std::size_t(2 * kCount));
  for (const ConventionReport::SurfaceFacts& s : report.surfaces) EXPECT_NEAR((s.upper - s.lower).x(), 0.5, 0.01) << s.id;
  for (const ConventionReport::FrameFacts& f : report.frames) {
    EXPECT_GT(f.vertices, 0);
    EXPECT_EQ(f.verticesInImage, f.vertices) << f.id;
    EXPECT_EQ(f.verticesInFront, f.vertices) << f.id;
    EXPECT_NEAR(f.distance, 2, 1e-9) << f.id;
  }
}

}  // namespace
}  // namespace glint
