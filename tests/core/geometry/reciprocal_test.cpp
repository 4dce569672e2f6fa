// SPDX-License-Identifier: BSD-3-Clause
// Tangent planes of cones and their dual points, against closed forms.
#include "core/geometry/reciprocal.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace glint {
namespace reciprocal_tests {

constexpr double kExact = 1e-12;  // round-off of numbers about 1

Camera cameraAt(const Eigen::Vector3d& eye) {  // looks along +z of the world
  Camera c;
  c.pixelFromRay << 800, 0, 320, 0, 800, 240, 0, 0, 1;
  c.camFromWorld.translation() = -eye;
  c.width = 640;
  c.height = 480;
  return c;
}

Ellipsoid ball(const Eigen::Vector3d& centre, double radius) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = centre;
  return Ellipsoid(pose, Eigen::Vector3d::Constant(radius));
}

Ellipsoid turned(const Eigen::Vector3d& centre, const Eigen::Vector3d& axes) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = centre;
  pose.linear() = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, -1).normalized()).toRotationMatrix();
  return Ellipsoid(pose, axes);
}

/// Outline of a ball on the optical axis: a circle of radius f r / sqrt(D^2 - r^2).
Ellipse outlineOfBall(double radius, double distance) {
  const double px = 800 * radius / std::sqrt(distance * distance - radius * radius);
  return {Pixel(320, 240), Eigen::Vector2d(px, px), 0};
}

TEST(ConePlanes, OfABallTouchTheBall) {
  const Camera camera = cameraAt({0, 0, -2});
  const auto planes = conePlanes(camera.projection(), outlineOfBall(0.3, 2), 36);
  ASSERT_TRUE(planes);
  ASSERT_EQ(planes->size(), 36u);
  for (const ConePlane& p : *planes) {
    EXPECT_NEAR(p.plane.normal.norm(), 1, kExact);
    EXPECT_NEAR(p.plane.signedDistance({0, 0, -2}), 0, kExact) << "it goes through the camera";
    EXPECT_NEAR(p.plane.signedDistance({0, 0, 0}), -0.3, kExact) << "the ball's centre lies inside, one radius away";
    EXPECT_NEAR(p.plane.normal.dot(p.along), 0, kExact);
    EXPECT_NEAR(p.along.z(), std::sqrt(1 - 0.15 * 0.15), kExact) << "sin of the half angle of the cone is r / D";
  }
}

TEST(ConePlanes, OfAMirroredCameraAreTheMirroredPlanes) {
  const Camera camera = cameraAt({0, 0, -2});
  const Plane mirror = Plane::through({0.1, 0, 1}, Eigen::Vector3d(0.2, -0.3, -1).normalized());
  const auto planes = conePlanes(virtualCamera(camera, mirror), outlineOfBall(0.3, 2), 24);
  ASSERT_TRUE(planes);
  const Eigen::Vector3d eye = mirror.reflected({0, 0, -2}), middle = mirror.reflected({0, 0, 0});
  for (const ConePlane& p : *planes) {
    EXPECT_NEAR(p.plane.signedDistance(eye), 0, kExact);
    EXPECT_NEAR(p.plane.signedDistance(middle), -0.3, kExact);
    EXPECT_GT(p.along.dot(middle - eye), 0);
  }
  EXPECT_LT((*centreOf(virtualCamera(camera, mirror)) - eye).norm(), kExact);
}

TEST(ConePlanes, AreTheSameInAnyUnitAndFarFromTheOrigin) {
  for (const double unit : {1e-4, 1.0, 1e5}) {
    const Eigen::Vector3d far = unit * Eigen::Vector3d(300, -200, 500);
    const Camera camera = cameraAt(far + unit * Eigen::Vector3d(0, 0, -2));
    const auto planes = conePlanes(camera.projection(), outlineOfBall(0.3, 2), 12);
    ASSERT_TRUE(planes);
    for (const ConePlane& p : *planes) EXPECT_NEAR(p.plane.signedDistance(far) / unit, -0.3, 1e-11);  // 600 units from the origin
  }
}

TEST(ConePlanes, FollowTheNoiseOfTheOutline) {
  // A circle that is e px too large: the half angle t of the cone grows by cos^2 t e / f, the distance by D cos t times that.
  const double error = 0.05, distance = 2, radius = 0.3, sine = radius / distance, cosine = std::sqrt(1 - sine * sine);
  Ellipse outline = outlineOfBall(radius, distance);
  outline.semiAxes.array() += error;
  const auto planes = conePlanes(cameraAt({0, 0, -2}).projection(), outline, 12);
  ASSERT_TRUE(planes);
  const double expected = distance * cosine * cosine * cosine * error / 800;
  for (const ConePlane& p : *planes) EXPECT_NEAR(-p.plane.signedDistance({0, 0, 0}) - radius, expected, 0.001 * expected);
}

TEST(ConePlanes, NeedACentreOfProjection) {
  Projection parallel;
  parallel.matrix << 800, 0, 0, 320, 0, 800, 0, 240, 0, 0, 0, 1;
  const auto planes = conePlanes(parallel, outlineOfBall(0.3, 2), 12);
  ASSERT_FALSE(planes);
  EXPECT_EQ(planes.failure().reason, Reason::RankDeficient);
  Projection broken = cameraAt({0, 0, -2}).projection();
  broken.matrix(1, 2) = std::nan("");
  EXPECT_EQ(conePlanes(broken, outlineOfBall(0.3, 2), 12).failure().reason, Reason::NotFinite);
}

TEST(Reciprocal, OfABallAboutItsCentreIsABallOfInverseRadius) {
  const auto dual = reciprocal(ball({1, 2, 3}, 0.25), {{1, 2, 3}, 1});
  ASSERT_TRUE(dual);
  EXPECT_LT((dual->semiAxes() - Eigen::Vector3d::Constant(4)).norm(), kExact);
  EXPECT_LT(dual->centre().norm(), kExact);
}

TEST(Reciprocal, OfAnEllipsoidHasItsAxesAndInverseSemiAxes) {
  const Ellipsoid e = turned({1, 2, 3}, {0.5, 0.2, 0.1});
  const auto dual = reciprocal(e, {{1, 2, 3}, 0.2});
  ASSERT_TRUE(dual);
  EXPECT_LT((dual->semiAxes() - Eigen::Vector3d(0.4, 0.2, 0.08)).norm(), kExact);  // 0.04 / a
  for (int k = 0; k < 3; ++k)
    EXPECT_NEAR(std::abs(dual->worldFromBody().linear().col(2 - k).dot(e.worldFromBody().linear().col(k))), 1, kExact);
}

TEST(Reciprocal, OfABallAboutAnotherPointHasThatPointAsFocus) {
  // The reciprocal of a sphere is a quadric of revolution with a focus at the chart's centre, eccentricity d / r and semi-latus
  // rectum radius^2 / r (Coxeter and Greitzer, Geometry Revisited, sec. 6.6).
  const double r = 0.5, d = 0.3, e = d / r, latus = 1 / r;
  const auto dual = reciprocal(ball({0, 0, d}, r), {{0, 0, 0}, 1});
  ASSERT_TRUE(dual);
  const double a = latus / (1 - e * e), b = a * std::sqrt(1 - e * e);
  EXPECT_LT((dual->semiAxes() - Eigen::Vector3d(a, b, b)).norm(), 1e-11);
  EXPECT_LT((dual->centre() - Eigen::Vector3d(0, 0, -a * e)).norm(), 1e-11);
}

TEST(Reciprocal, HasTheDualPointsOfTheTangentPlanesOnIt) {
  const Ellipsoid e = turned({1, 2, 3}, {0.5, 0.2, 0.1});
  for (const double unit : {1e-3, 1.0, 1e4}) {
    const Ellipsoid scaled = turned(unit * Eigen::Vector3d(1, 2, 3), unit * Eigen::Vector3d(0.5, 0.2, 0.1));
    const Reciprocal chart{unit * Eigen::Vector3d(1.05, 2.02, 3.01), unit * 0.2};
    const auto dual = reciprocal(scaled, chart);
    ASSERT_TRUE(dual);
    const Eigen::Matrix3d inverse = dual->shape().inverse();
    for (int i = 0; i < 20; ++i) {
      const Eigen::Vector3d n = Eigen::Vector3d(std::sin(i), std::cos(2.3 * i), std::sin(0.7 * i + 1)).normalized();
      // The tangent plane with normal n lies sqrt(n^T S n) from the centre.
      const Plane plane = Plane::through(scaled.centre() + unit * std::sqrt(n.dot(e.shape() * n)) * n, n);
      const auto y = dualPoint(plane, chart);
      ASSERT_TRUE(y);
      const Eigen::Vector3d from = *y - dual->centre();
      EXPECT_NEAR(from.dot(inverse * from), 1, 1e-9);
      EXPECT_NEAR(y->norm() * std::abs(plane.signedDistance(chart.centre)) / (chart.radius * chart.radius), 1, 1e-9);
    }
  }
}

TEST(Reciprocal, OfPlanesThroughOnePointLieInOnePlane) {
  const Camera camera = cameraAt({0.2, -0.1, -2});
  const auto planes = conePlanes(camera.projection(), Ellipse{Pixel(350, 200), {90, 40}, 0.4}, 24);
  ASSERT_TRUE(planes);
  const Reciprocal chart{{0, 0, 0.1}, 0.3};
  const Eigen::Vector3d eye = Eigen::Vector3d(0.2, -0.1, -2) - chart.centre;
  for (const ConePlane& p : *planes) EXPECT_NEAR(dualPoint(p.plane, chart)->dot(eye), 0.09, 1e-9);
}

TEST(Reciprocal, IsNoEllipsoidAboutAPointThatIsNotInside) {
  for (const double z : {0.5, 0.7}) {
    const auto dual = reciprocal(ball({0, 0, z}, 0.5), {{0, 0, 0}, 1});
    ASSERT_FALSE(dual) << z;
    EXPECT_EQ(dual.failure().reason, Reason::NotAnEllipsoid);
  }
  EXPECT_EQ(reciprocal(turned({0, 0, 0}, {0.5, 0.2, 0}), {{0, 0, 0}, 1}).failure().reason, Reason::NotAnEllipsoid);
  const auto through = dualPoint(Plane::through({300, 200, 100}, Eigen::Vector3d(1, 2, -1).normalized()), {{300, 200, 100}, 1});
  ASSERT_FALSE(through);
  EXPECT_EQ(through.failure().reason, Reason::RankDeficient);
}

TEST(Reciprocal, FollowsTheNoiseOfThePlanes) {
  // A plane that is off by e from a ball of radius r gives a point off by -radius^2 e / r^2, to first order.
  const double r = 0.25, error = 1e-5;
  const Plane plane = Plane::through({r + error, 0, 0}, {1, 0, 0});
  EXPECT_NEAR(dualPoint(plane, {{0, 0, 0}, 1})->x() - 1 / r, -error / (r * r), 1e-4 * error / (r * r));
}

}  // namespace reciprocal_tests
}  // namespace glint
