// SPDX-License-Identifier: BSD-3-Clause
// Poses as people type them. The rotation is (0.36 0.48 -0.8; -0.8 0.6 0; 0.48 0.64 0.6), whose digits are exact.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <limits>

#include "core/geometry/transforms.h"

namespace glint::typed_pose_tests {
namespace {

Eigen::Matrix3d exact() { return (Eigen::Matrix3d() << 0.36, 0.48, -0.8, -0.8, 0.6, 0, 0.48, 0.64, 0.6).finished(); }

TEST(TypedPose, ARotationStaysAsItIs) {
  const Eigen::Vector3d t(0.1, -0.2, 2);
  const TypedPose typed = typedPose(exact(), t);
  EXPECT_EQ(typed.rotation, TypedRotation::Exact);
  EXPECT_EQ(typed.pose.linear(), exact());
  EXPECT_EQ(typed.pose.translation(), t);
}

TEST(TypedPose, FewDigitsAreRepairedAndTheCentreStays) {
  for (const double scale : {1e-3, 1.0, 1e6}) {
    Eigen::Matrix3d typed = exact();
    typed(0, 0) = 0.3604;  // three digits and a wrong fourth
    const Eigen::Vector3d centre = scale * Eigen::Vector3d(1, -2, 3), t = -typed * centre;
    const TypedPose result = typedPose(typed, t);
    EXPECT_EQ(result.rotation, TypedRotation::Repaired);
    const Eigen::Matrix3d r = result.pose.linear();
    EXPECT_LT((r.transpose() * r - Eigen::Matrix3d::Identity()).norm(), 1e-14);
    EXPECT_LT((r - exact()).norm(), 4e-4);  // no farther than what was typed
    EXPECT_LT((result.pose.inverse().translation() - centre).norm(), 1e-12 * scale);
  }
}

TEST(TypedPose, FarFromTheOriginTheCentreStaysWithoutAWord) {
  Eigen::Matrix3d typed = exact();
  typed(1, 1) = 0.6000000001;
  const Eigen::Vector3d centre(1e5, 2e5, -3e5);
  const TypedPose result = typedPose(typed, -typed * centre);
  EXPECT_EQ(result.rotation, TypedRotation::Exact);
  EXPECT_LT((result.pose.linear().transpose() * result.pose.linear() - Eigen::Matrix3d::Identity()).norm(), 1e-14);
  EXPECT_LT((result.pose.inverse().translation() - centre).norm(), 1e-8);
}

TEST(TypedPose, WhatIsNoRotationIsNamed) {
  EXPECT_EQ(typedPose(2 * exact(), {0, 0, 0}).rotation, TypedRotation::NotARotation);
  EXPECT_EQ(typedPose(Eigen::Matrix3d::Zero(), {0, 0, 0}).rotation, TypedRotation::NotARotation);
  EXPECT_EQ(typedPose(-exact(), {0, 0, 0}).rotation, TypedRotation::Mirrored);
  Eigen::Matrix3d nan = exact();
  nan(2, 2) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(typedPose(nan, {0, 0, 0}).rotation, TypedRotation::NotARotation);
}

}  // namespace
}  // namespace glint::typed_pose_tests
