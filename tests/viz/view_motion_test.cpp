// SPDX-License-Identifier: BSD-3-Clause
// The point that a view is moved about must not move in the picture: a pinhole projection written here says where it is.
#include "viz/view_motion.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

namespace glint::viz {
namespace view_motion_tests {

constexpr double kSame = 1e-12;

ViewPoint someView() {
  ViewPoint v;
  v.position = {2, -3, 1.5};
  v.focalPoint = {0.1, 0.2, 0.3};
  v.up = {0, 0, 1};
  return v;
}

/// Where a point is in the picture, in units of its half height; parallel views are as high as a perspective one at the focal
/// point.
Eigen::Vector2d inPicture(const ViewPoint& v, const Eigen::Vector3d& point) {
  const Eigen::Vector3d ahead = (v.focalPoint - v.position).normalized();
  const Eigen::Vector3d right = ahead.cross(v.up).normalized(), up = right.cross(ahead), d = point - v.position;
  const double depth = v.parallel ? (v.focalPoint - v.position).norm() : d.dot(ahead);
  return Eigen::Vector2d(d.dot(right), d.dot(up)) / (depth * std::tan(v.viewAngleDeg * std::numbers::pi / 360));
}

TEST(ViewMotion, ZoomKeepsThePointAndEnlargesWhatIsAtItsDepth) {
  for (const bool parallel : {false, true}) {
    ViewPoint view = someView();
    view.parallel = parallel;
    const Eigen::Vector3d point(0.4, 0.5, -0.2);
    const Eigen::Vector3d ahead = (view.focalPoint - view.position).normalized();
    const Eigen::Vector3d beside = point + 0.01 * ahead.cross(view.up).normalized();
    const ViewPoint nearer = zoomedAbout(view, point, 1.5);
    EXPECT_LT((inPicture(nearer, point) - inPicture(view, point)).norm(), kSame);
    const double before = (inPicture(view, beside) - inPicture(view, point)).norm();
    EXPECT_NEAR((inPicture(nearer, beside) - inPicture(nearer, point)).norm(), 1.5 * before, 1e-9);
    const ViewPoint back = zoomedAbout(nearer, point, 1 / 1.5);
    EXPECT_LT((back.position - view.position).norm() + (back.focalPoint - view.focalPoint).norm(), kSame);
  }
}

TEST(ViewMotion, TurningKeepsThePointWhereItIs) {
  const ViewPoint view = someView();
  const Eigen::Vector3d point(0.4, 0.5, -0.2);
  const ViewPoint turned = turnedAbout(view, point, 0.3, -0.2);
  EXPECT_LT((inPicture(turned, point) - inPicture(view, point)).norm(), kSame);
  EXPECT_NEAR((turned.position - turned.focalPoint).norm(), (view.position - view.focalPoint).norm(), kSame);
  EXPECT_NEAR((turned.position - point).norm(), (view.position - point).norm(), kSame);
}

/// Pulled to the right, what is before the point goes to the right; pulled upwards, upwards.
TEST(ViewMotion, TheNearSideFollowsTheHand) {
  const ViewPoint view = someView();
  const Eigen::Vector3d near = view.focalPoint + 0.2 * (view.position - view.focalPoint).normalized();
  const Eigen::Vector2d before = inPicture(view, near);
  EXPECT_GT((inPicture(turnedAbout(view, view.focalPoint, 0.1, 0), near) - before).x(), 0.001);
  EXPECT_GT((inPicture(turnedAbout(view, view.focalPoint, 0, 0.1), near) - before).y(), 0.001);
}

TEST(ViewMotion, SizeOfTheWorldChangesNothing) {
  ViewPoint large = someView();
  large.position *= 1e6;
  large.focalPoint *= 1e6;
  const Eigen::Vector3d point(0.4, 0.5, -0.2);
  const ViewPoint a = turnedAbout(someView(), point, 0.4, 0.1), b = turnedAbout(large, 1e6 * point, 0.4, 0.1);
  EXPECT_LT((b.position / 1e6 - a.position).norm(), kSame);
  EXPECT_LT((b.up - a.up).norm(), kSame);
}

}  // namespace view_motion_tests
}  // namespace glint::viz
