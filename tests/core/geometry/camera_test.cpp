// SPDX-License-Identifier: BSD-3-Clause
#include "core/geometry/camera.h"

#include <gtest/gtest.h>

#include <opencv2/calib3d.hpp>

#include "tests/tolerances.h"

namespace glint {
namespace {
using tolerance::kExact;

Camera example() {
  Camera c;
  c.pixelFromRay << 800, 0.5, 320, 0, 790, 240, 0, 0, 1;
  c.camFromWorld = Eigen::Isometry3d::Identity();
  c.camFromWorld.rotate(Eigen::AngleAxisd(0.4, Eigen::Vector3d(1, -2, 0.5).normalized()));
  c.camFromWorld.pretranslate(Eigen::Vector3d(0.1, -0.2, 2));
  c.width = 640;
  c.height = 480;
  return c;
}

// By hand: K = [800 0 320; 0 800 240; 0 0 1], camera at (0, 0, -2): X = (0.5, -0.25, 2) lies at depth 4.
TEST(Camera, ProjectsByHand) {
  Camera c;
  c.pixelFromRay << 800, 0, 320, 0, 800, 240, 0, 0, 1;
  c.camFromWorld = Eigen::Translation3d(0, 0, 2);
  EXPECT_NEAR((*c.project({0.5, -0.25, 2}) - Pixel(420, 190)).norm(), 0, kExact);
  EXPECT_NEAR((c.centreInWorld() - Eigen::Vector3d(0, 0, -2)).norm(), 0, kExact);
  EXPECT_DOUBLE_EQ(c.depth({0.5, -0.25, 2}), 4);
  EXPECT_FALSE(c.project({0, 0, -3}));
  EXPECT_FALSE(c.project({0, 0, -2}));
  EXPECT_FALSE(c.project({0, 0, NAN}));
}

TEST(Camera, RayProjectionAndCentreAgree) {
  const Camera c = example();
  const Eigen::Vector3d x(0.3, 0.2, 0.7);
  const Pixel p = *c.project(x);
  EXPECT_NEAR((c.projection().project(x) - p).norm(), 0, 1e-10);
  const Ray ray = c.ray(p);
  EXPECT_NEAR(ray.direction.norm(), 1, kExact);
  EXPECT_NEAR((ray.at((x - ray.origin).norm()) - x).norm(), 0, kExact);
  EXPECT_NEAR((c.camFromWorld * c.centreInWorld()).norm(), 0, kExact);
}

TEST(Camera, DistortionAgreesWithOpenCv) {
  Camera c = example();
  c.pixelFromRay(0, 1) = 0;  // OpenCV knows no skew
  c.lens.parameters = {-0.21, 0.07, 0.001, -0.0015, 0.01};
  ASSERT_TRUE(c.hasDistortion());
  const cv::Matx33d k(800, 0, 320, 0, 790, 240, 0, 0, 1);
  const std::vector<double> d(c.lens.parameters.begin(), c.lens.parameters.begin() + 5);
  for (const Pixel& ideal : {Pixel(320, 240), Pixel(10, 20), Pixel(600, 470), Pixel(50, 400)}) {
    std::vector<cv::Point2d> out;
    const std::vector<cv::Point3d> in{{(ideal.x() - 320) / 800, (ideal.y() - 240) / 790, 1.0}};
    cv::projectPoints(in, cv::Vec3d(0, 0, 0), cv::Vec3d(0, 0, 0), k, d, out);
    const Pixel measured = c.distorted(ideal);
    EXPECT_NEAR(measured.x(), out[0].x, 1e-9);
    EXPECT_NEAR(measured.y(), out[0].y, 1e-9);
    EXPECT_NEAR((c.undistorted(measured) - ideal).norm(), 0, 1e-9);
  }
  EXPECT_GT((c.distorted({10, 20}) - Pixel(10, 20)).norm(), 5);  // the test would see a missing distortion
}

TEST(Camera, WithoutDistortionPixelsPassUntouched) {
  const Camera c = example();
  EXPECT_FALSE(c.hasDistortion());
  EXPECT_EQ(c.undistorted({12.25, 7.5}), Pixel(12.25, 7.5));
  EXPECT_EQ(c.distorted({12.25, 7.5}), Pixel(12.25, 7.5));
}

}  // namespace
}  // namespace glint
