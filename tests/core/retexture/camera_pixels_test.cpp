// SPDX-License-Identifier: BSD-3-Clause
// The pixels of a camera: against the pinhole's closed form, and the lens model run forwards.
#include <gtest/gtest.h>

#include "core/retexture/pixels.h"
#include "core/surface/analytic.h"

namespace glint::camera_pixels_tests {

Camera above(double height) {
  Camera camera;
  camera.pixelFromRay << 50, 0, 19.5, 0, 50, 14.5, 0, 0, 1;
  camera.width = 40;
  camera.height = 30;
  camera.camFromWorld.linear() = Eigen::Vector3d(1, -1, -1).asDiagonal();
  camera.camFromWorld.translation() = Eigen::Vector3d(0, 0, height);
  return camera;
}

TEST(ForEachPixel, EachOnceAndWithoutDistortion) {
  Camera camera = above(2);
  camera.lens.parameters[0] = -0.2;
  std::vector<int> visits(40 * 30, 0);
  double worst = 0;
  std::vector<Pixel> ideal(visits.size());
  forEachPixel(
      camera, [&](std::size_t i, const Pixel& p) { ++visits[i], ideal[i] = p; }, {}, "test");
  for (std::size_t i = 0; i < visits.size(); ++i) {
    EXPECT_EQ(visits[i], 1);
    const Eigen::Vector2d q = (ideal[i] - Pixel(19.5, 14.5)) / 50;
    const Pixel back = 50 * (1 - 0.2 * q.squaredNorm()) * q + Pixel(19.5, 14.5);
    worst = std::max(worst, (back - Pixel(double(i % 40), double(i / 40))).norm());
  }
  EXPECT_LT(worst, 1e-9);
}

TEST(ForEachSurfacePixel, OnlyThoseThatShowItWithNormalsTowardsTheCamera) {
  AnalyticSpec sphere;
  sphere.type = "sphere";
  sphere.radius = 0.5;
  const std::shared_ptr<const Surface> surface = makeAnalytic(sphere);
  const Camera camera = above(2);
  std::vector<char> seen(40 * 30, 0);
  forEachSurfacePixel(
      camera, *surface,
      [&](std::size_t i, const SurfacePoint& p) {
        seen[i] = 1;
        EXPECT_GT(p.normal.z(), 0);
        EXPECT_NEAR(p.position.norm(), 0.5, 1e-9);
      },
      {}, "test");
  // A ray of slope s hits where s^2 <= r^2 / (h^2 - r^2): the outline of a sphere on the axis.
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const double slope2 = (Pixel(double(i % 40), double(i / 40)) - Pixel(19.5, 14.5)).squaredNorm() / (50. * 50.);
    EXPECT_EQ(seen[i] != 0, slope2 <= 0.25 / (4 - 0.25)) << i;
  }
}

TEST(ForEachSurfacePixel, NormalsOfAPlaneSeenFromBehind) {
  AnalyticSpec plane;
  plane.type = "plane";
  Camera below = above(2);
  below.camFromWorld.linear().setIdentity();  // from (0, 0, -2) along +z; the plane's own normal is +z
  int seen = 0;
  forEachSurfacePixel(
      below, *makeAnalytic(plane),
      [&](std::size_t i, const SurfacePoint& p) {
        seen += i == 0;
        EXPECT_NEAR(p.normal.z(), -1, 1e-12);
      },
      {}, "test");
  EXPECT_EQ(seen, 1);
}

TEST(ForEachPixel, Stops) {
  EXPECT_THROW(forEachPixel(
                   above(2), [](std::size_t, const Pixel&) {}, [](const StageEvent&) { return false; }, "test"),
               Stopped);
}

}  // namespace glint::camera_pixels_tests
