// SPDX-License-Identifier: BSD-3-Clause
#include "core/geometry/epipolar.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "core/geometry/ellipsoid.h"
#include "core/geometry/plane.h"

namespace glint {
namespace {

Camera cameraAt(const Eigen::Vector3d& position, const Eigen::Vector3d& target, double focal = 800) {
  const Eigen::Vector3d z = (target - position).normalized(), x = Eigen::Vector3d(0, 1, 0).cross(z).normalized();
  Camera camera;
  camera.pixelFromRay << focal, 0, 319.5, 0, focal, 239.5, 0, 0, 1;
  Eigen::Matrix3d worldFromCam;
  worldFromCam << x, z.cross(x), z;
  camera.camFromWorld = Eigen::Isometry3d::Identity();
  camera.camFromWorld.linear() = worldFromCam.transpose();
  camera.camFromWorld.translation() = -worldFromCam.transpose() * position;
  camera.width = 640;
  camera.height = 480;
  return camera;
}

Ellipsoid ball(const Eigen::Vector3d& centre, double radius) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = centre;
  return Ellipsoid(pose, Eigen::Vector3d::Constant(radius));
}

TEST(EqFundamental, ImagesOfOnePointLieOnEachOthersEpipolarLines) {
  const Camera a = cameraAt({-0.4, 0.1, -2}, {0, 0, 0}), b = cameraAt({0.7, -0.2, -1.8}, {0.1, 0, 0});
  const Outcome<Eigen::Matrix3d> f = fundamentalMatrix(a.projection(), b.projection());
  ASSERT_TRUE(f);
  for (const Eigen::Vector3d& x : {Eigen::Vector3d(0.1, 0.2, 0.3), {-0.3, 0.05, 0.1}, {0.2, -0.25, -0.2}}) {
    const Eigen::Vector3d line = *f * a.projection().project(x).homogeneous();
    EXPECT_NEAR(line.dot(b.projection().project(x).homogeneous()) / line.head<2>().norm(), 0, 1e-9);
  }
  EXPECT_EQ(fundamentalMatrix(a.projection(), a.projection()).failure().reason, Reason::RankDeficient);
}

/// Two cameras side by side with parallel axes: epipolar lines are rows. Two circles of radius r whose rows differ by d: each
/// carried tangent misses by d, one outside, one inside.
TEST(EpipolarTangents, RowsOfARectifiedPair) {
  Camera a = cameraAt({0, 0, -2}, {0, 0, 0}), b = cameraAt({0.5, 0, -2}, {0.5, 0, 0});
  const Ellipse left{{300, 200}, {20, 20}, 0}, right{{150, 203}, {20, 20}, 0};
  const Outcome<EpipolarTangents> t = epipolarTangents(a.projection(), left, b.projection(), right);
  ASSERT_TRUE(t);
  for (const EpipolarView* view : {&t->first, &t->second}) {
    EXPECT_NEAR(view->epipole.z(), 0, 1e-12);
    EXPECT_NEAR(std::abs(view->missPx[0]), 3, 1e-9);
    EXPECT_NEAR(view->missPx[0] + view->missPx[1], 0, 1e-9);
    for (const Eigen::Vector3d& line : view->tangents) EXPECT_NEAR(line.x(), 0, 1e-12);
  }
  // Rows 180 and 220 touch the left circle, 183 and 223 the right one: each passes outside the other circle or cuts it.
  for (std::size_t i = 0; i < 2; ++i) {
    const bool upper = t->first.contacts[i].y() < 200;
    EXPECT_EQ(t->second.contacts[i].y() < 203, upper) << "upper belongs to upper";
    EXPECT_NEAR(t->second.missPx[i], upper ? 3 : -3, 1e-9);
    EXPECT_NEAR(t->first.missPx[i], upper ? -3 : 3, 1e-9);
  }
  EXPECT_NEAR(t->rmsPx(), 3, 1e-9);
  EXPECT_NEAR(std::abs(t->second.contacts[0].y() - 203), 20, 1e-9);
  EXPECT_NEAR(t->second.contacts[0].x(), 150, 1e-9);
}

TEST(EpipolarTangents, TheOutlinesOfASphereMatch) {
  const Eigen::Vector3d centre(0.1, -0.05, 0.2);
  const double radius = 0.3;
  const Camera a = cameraAt({-0.6, 0.2, -2}, {0, 0, 0}), b = cameraAt({0.9, -0.3, -1.5}, {0.1, 0, 0});
  const Outcome<Ellipse> e1 = outlineEllipse(ball(centre, radius), a.projection()),
                         e2 = outlineEllipse(ball(centre, radius), b.projection());
  ASSERT_TRUE(e1 && e2);
  const Outcome<EpipolarTangents> t = epipolarTangents(a.projection(), *e1, b.projection(), *e2);
  ASSERT_TRUE(t);
  EXPECT_LT(t->rmsPx(), 1e-8);
  for (std::size_t i = 0; i < 2; ++i) {
    // The plane through the centre of the camera and the tangent touches the sphere, and both images have the same plane.
    const Eigen::Vector4d plane1 = a.projection().matrix.transpose() * t->first.tangents[i],
                          plane2 = b.projection().matrix.transpose() * t->second.tangents[i];
    EXPECT_NEAR(std::abs(plane1.dot(centre.homogeneous())) / plane1.head<3>().norm(), radius, 1e-9);
    EXPECT_NEAR(std::abs(plane1.head<3>().normalized().dot(plane2.head<3>().normalized())), 1, 1e-9);
    EXPECT_NEAR(t->first.tangents[i].dot(t->first.contacts[i].homogeneous()), 0, 1e-8);
    EXPECT_NEAR(e1->conic().matrix.row(2).dot(t->first.contacts[i].homogeneous()) +
                    t->first.contacts[i].dot(e1->conic().matrix.topRows<2>() * t->first.contacts[i].homogeneous()),
                0, 1e-9);
  }
}

/// Whichever way the cameras stand to each other, and where one of them is mirrored: tangents of the two images that belong to
/// each other lie in one plane, which touches the ball.
TEST(EpipolarTangents, PartnersLieInOnePlaneForEveryPairOfCameras) {
  const Eigen::Vector3d centre(0.1, -0.05, 0.2);
  const Ellipsoid e = ball(centre, 0.15);
  std::vector<Projection> views;
  for (const double degrees : {0, 40, 100, 170, 250}) {
    const double a = degrees / 57.29577951308232;
    const Camera c = cameraAt({2 * std::sin(a), 0.3 - 0.002 * degrees, -2 * std::cos(a)}, {0, 0, 0});
    views.push_back(c.projection());
    views.push_back(virtualCamera(c, Plane::through({0.2, -0.9, 0.3}, Eigen::Vector3d(0.1, 1, 0.2).normalized())));
  }
  for (std::size_t a = 0; a < views.size(); ++a)
    for (std::size_t b = 0; b < views.size(); ++b) {
      SCOPED_TRACE(std::to_string(a) + " " + std::to_string(b));
      const Outcome<EpipolarTangents> t =
          epipolarTangents(views[a], *outlineEllipse(e, views[a]), views[b], *outlineEllipse(e, views[b]));
      if (a == b) {
        EXPECT_FALSE(t);
        continue;
      }
      ASSERT_TRUE(t);
      EXPECT_LT(t->rmsPx(), 1e-7);
      for (std::size_t i = 0; i < 2; ++i) {
        const Eigen::Vector4d plane1 = views[a].matrix.transpose() * t->first.tangents[i],
                              plane2 = views[b].matrix.transpose() * t->second.tangents[i];
        EXPECT_NEAR(std::abs(plane1.dot(centre.homogeneous())) / plane1.head<3>().norm(), 0.15, 1e-9);
        EXPECT_NEAR(std::abs(plane1.head<3>().normalized().dot(plane2.head<3>().normalized())), 1, 1e-9);
      }
    }
}

/// Reflected in one plane, a pair has the same epipolar lines: on a plane `primal` and `dual` agree. Reflected in two planes, as
/// on a curved surface, the mirrored sphere matches with virtual cameras and not with the real ones.
TEST(EpipolarTangents, VirtualCamerasMatchWhereRealOnesDoNot) {
  const Camera a = cameraAt({-0.6, 0.2, -2}, {0, 0, 0}), b = cameraAt({0.9, -0.3, -1.5}, {0.1, 0, 0});
  const Plane one = Plane::through({0, 0, 0}, Eigen::Vector3d(0.05, 0.1, -1).normalized()),
              other = Plane::through({0.05, 0, 0.01}, Eigen::Vector3d(0.3, 0.05, -1).normalized());
  const Ellipsoid mirrored = ball({0.1, 0.6, -1.4}, 0.1);
  const Projection va = virtualCamera(a, one), vbSame = virtualCamera(b, one), vb = virtualCamera(b, other);
  const Outcome<Ellipse> e1 = outlineEllipse(mirrored, va), same = outlineEllipse(mirrored, vbSame),
                         bent = outlineEllipse(mirrored, vb);
  ASSERT_TRUE(e1 && same && bent);
  EXPECT_LT(epipolarTangents(va, *e1, vbSame, *same)->rmsPx(), 1e-8);
  EXPECT_LT(epipolarTangents(a.projection(), *e1, b.projection(), *same)->rmsPx(), 1e-8);
  EXPECT_LT(epipolarTangents(va, *e1, vb, *bent)->rmsPx(), 1e-8);
  EXPECT_GT(epipolarTangents(a.projection(), *e1, b.projection(), *bent)->rmsPx(), 1);
}

TEST(EpipolarTangents, Scale) {
  for (const double scale : {1e-6, 1e-3, 1e3, 1e6}) {
    const Camera a = cameraAt(scale * Eigen::Vector3d(-0.6, 0.2, -2), {0, 0, 0}),
                 b = cameraAt(scale * Eigen::Vector3d(0.9, -0.3, -1.5), scale * Eigen::Vector3d(0.1, 0, 0));
    const Ellipsoid e = ball(scale * Eigen::Vector3d(0.1, -0.05, 0.2), scale * 0.3);
    EXPECT_LT(
        epipolarTangents(a.projection(), *outlineEllipse(e, a.projection()), b.projection(), *outlineEllipse(e, b.projection()))
            ->rmsPx(),
        1e-7)
        << scale;
  }
}

TEST(EpipolarTangents, Degenerate) {
  const Camera a = cameraAt({0, 0, -2}, {0, 0, 0});
  const Camera ahead = cameraAt({0, 0, -1}, {0, 0, 0});  // the epipole is the middle of the image
  const Ellipse e{{319.5, 239.5}, {30, 20}, 0.2};
  EXPECT_EQ(epipolarTangents(a.projection(), e, ahead.projection(), e).failure().reason, Reason::NotAnEllipse);
  EXPECT_EQ(epipolarTangents(a.projection(), e, a.projection(), e).failure().reason, Reason::RankDeficient);
  Projection bad = a.projection();
  bad.matrix(0, 0) = std::nan("");
  EXPECT_EQ(epipolarTangents(bad, e, ahead.projection(), e).failure().reason, Reason::NotFinite);
}

}  // namespace
}  // namespace glint
