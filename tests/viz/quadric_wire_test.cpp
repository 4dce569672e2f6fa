// SPDX-License-Identifier: BSD-3-Clause
#include "viz/quadric_wire.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

namespace glint::viz {
namespace {

Eigen::Matrix4d placed(const Eigen::Vector4d& diagonal, const Eigen::Vector3d& centre) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, -1).normalized()).toRotationMatrix();
  pose.translation() = centre;
  return pose.matrix() * diagonal.asDiagonal() * pose.matrix().transpose();
}

const Eigen::AlignedBox3d kRegion(Eigen::Vector3d(-3, -3, -3), Eigen::Vector3d(3, 3, 3));

struct Case {
  const char* kind;
  Eigen::Vector4d diagonal;  ///< of Q* in its own axes, -a^2 for a real axis a
};
class RealQuadric : public testing::TestWithParam<Case> {};

/// Every drawn point lies on the point quadric, the inverse of Q*.
TEST_P(RealQuadric, IsDrawnOnItsSurface) {
  const Eigen::Matrix4d dual = placed(GetParam().diagonal, {0.3, -0.2, 0.5});
  for (const double factor : {1.0, -1e-7, 1e7}) {
    const QuadricWire wire = wireOf({factor * dual}, kRegion);
    EXPECT_EQ(wire.kind, GetParam().kind);
    ASSERT_GT(wire.curves.size(), 5u);
    EXPECT_TRUE(wire.axes.empty());
    const Eigen::Matrix4d point = dual.inverse();
    Eigen::AlignedBox3d box;
    for (const Points& curve : wire.curves) {
      ASSERT_GE(curve.size(), 2u);
      for (const Eigen::Vector3d& p : curve) {
        EXPECT_NEAR(p.homogeneous().dot(point * p.homogeneous()), 0, 1e-8 * point.norm() * p.homogeneous().squaredNorm());
        EXPECT_LE(p.norm(), 0.5 * kRegion.diagonal().norm() + 1e-9);
        box.extend(p);
      }
    }
    EXPECT_GT(box.diagonal().norm(), 3);  // it fills the picture
    EXPECT_TRUE(wire.anchor.allFinite());
  }
}
INSTANTIATE_TEST_SUITE_P(QuadricWire, RealQuadric,
                         testing::Values(Case{"hyperboloid of two sheets", {-0.25, 0.09, 0.16, 1}},
                                         Case{"hyperboloid of one sheet", {-0.25, -0.09, 0.16, 1}}),
                         [](const auto& info) { return std::string(info.index == 0 ? "TwoSheets" : "OneSheet"); });

TEST(QuadricWire, AParaboloidHasNoCentreAndIsDrawnOnItsSurface) {
  Eigen::Matrix4d point = Eigen::Matrix4d::Zero();  // z = x^2 + 2 y^2, moved
  point(0, 0) = 1;
  point(1, 1) = 2;
  point(2, 3) = point(3, 2) = -0.5;
  const QuadricWire wire = wireOf({point.inverse()}, kRegion);
  EXPECT_EQ(wire.kind, "paraboloid");
  ASSERT_GT(wire.curves.size(), 5u);
  for (const Points& curve : wire.curves)
    for (const Eigen::Vector3d& p : curve) EXPECT_NEAR(p.x() * p.x() + 2 * p.y() * p.y(), p.z(), 1e-9);
}

TEST(QuadricWire, FlatOnesAreCurvesInTheirPlane) {
  const QuadricWire disc = wireOf({Eigen::Vector4d(-0.25, -0.09, 0, 1).asDiagonal()}, kRegion);
  ASSERT_EQ(disc.curves.size(), 1u);
  for (const Eigen::Vector3d& p : disc.curves[0]) {
    EXPECT_NEAR(p.x() * p.x() / 0.25 + p.y() * p.y() / 0.09, 1, 1e-12);
    EXPECT_NEAR(p.z(), 0, 1e-12);
  }
  const QuadricWire hyperbola = wireOf({Eigen::Vector4d(-0.25, 0.09, 0, 1).asDiagonal()}, kRegion);
  EXPECT_EQ(hyperbola.kind, "flat hyperboloid");
  ASSERT_EQ(hyperbola.curves.size(), 2u);
  for (const Points& branch : hyperbola.curves)
    for (const Eigen::Vector3d& p : branch) EXPECT_NEAR(p.x() * p.x() / 0.25 - p.y() * p.y() / 0.09, 1, 1e-9);
  const QuadricWire segment = wireOf({Eigen::Vector4d(-0.25, 0, 0, 1).asDiagonal()}, kRegion);
  ASSERT_EQ(segment.curves.size(), 1u);
  EXPECT_NEAR((segment.curves[0].front() - segment.curves[0].back()).norm(), 1, 1e-12);
}

TEST(QuadricWire, WhatHasNoRealSurfaceIsACross) {
  const QuadricWire imaginary = wireOf({placed({0.25, 0.09, 0.16, 1}, {1, 0, 0})}, kRegion);
  EXPECT_EQ(imaginary.kind, "imaginary ellipsoid");
  EXPECT_TRUE(imaginary.curves.empty());
  ASSERT_EQ(imaginary.axes.size(), 3u);
  EXPECT_LT((imaginary.anchor - Eigen::Vector3d(1, 0, 0)).norm(), 1e-12);
  EXPECT_EQ(wireOf({Eigen::Vector4d(0, 0, 0, 1).asDiagonal()}, kRegion).axes.size(), 3u);  // a point
}

TEST(QuadricWire, NothingIsDrawnOfWhatIsNothing) {
  const double nan = std::nan("");
  for (const Eigen::Matrix4d& matrix :
       {Eigen::Matrix4d(Eigen::Matrix4d::Zero()), Eigen::Matrix4d(Eigen::Matrix4d::Constant(nan)),
        Eigen::Matrix4d(Eigen::Vector4d(1, 1, 0, 0).asDiagonal()), Eigen::Matrix4d(Eigen::Vector4d(-1, 1, 1, 0).asDiagonal())}) {
    const QuadricWire wire = wireOf({matrix}, kRegion);
    EXPECT_TRUE(wire.curves.empty() && wire.axes.empty());
    EXPECT_FALSE(wire.kind.empty());
    EXPECT_EQ(wire.anchor, kRegion.center());
  }
}

}  // namespace
}  // namespace glint::viz
