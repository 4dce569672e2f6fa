// SPDX-License-Identifier: BSD-3-Clause
#include "core/geometry/ellipsoid.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "tests/tolerances.h"

namespace glint {
namespace {
using tolerance::kExact;

Ellipsoid sphere(double radius, const Eigen::Vector3d& centre = {0, 0, 0}) {
  return Ellipsoid(Eigen::Isometry3d(Eigen::Translation3d(centre)), Eigen::Vector3d::Constant(radius));
}
/// Camera at (0, 0, -distance) that looks along +z, with the principal point at (320, 240).
Projection lookAlongZ(double focal, double distance) {
  Projection p;
  p.matrix << focal, 0, 320, 320 * distance, 0, focal, 240, 240 * distance, 0, 0, 1, distance;
  return p;
}
Ellipsoid general() {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.rotate(Eigen::AngleAxisd(0.8, Eigen::Vector3d(1, 2, -1).normalized()));
  pose.pretranslate(Eigen::Vector3d(0.3, -0.2, 0.4));
  return Ellipsoid(pose, {0.5, 0.3, 0.2});
}

// r = f R / sqrt(d^2 - R^2); the naive f R / d would be 160.
TEST(Outline, UnitSphereOnAxis) {
  const Outcome<Ellipse> e = outlineEllipse(sphere(1.0), lookAlongZ(800.0, 5.0));
  ASSERT_TRUE(e);
  EXPECT_NEAR(e->semiAxes.x(), 163.29931618554522, 1e-9);
  EXPECT_NEAR(e->semiAxes.y(), 163.29931618554522, 1e-9);
  EXPECT_NEAR(e->centre.x(), 320, 1e-9);
}
// Its centre projects to u = 0.
TEST(Outline, CentreIsNotTheProjectedCentre) {
  const Outcome<Ellipse> e = outlineEllipse(sphere(1.0, {-2, 0, 0}), lookAlongZ(800.0, 5.0));
  ASSERT_TRUE(e);
  EXPECT_NEAR(e->centre.x(), -13.333333333333332, 1e-9);
}

TEST(Outline, EllipseAgreesWithTheDualConic) {
  Projection p = lookAlongZ(800, 3);
  const Outcome<Ellipse> direct = outlineEllipse(general(), p), dual = toEllipse(outline(general().dual(), p));
  ASSERT_TRUE(direct && dual);
  EXPECT_NEAR((direct->centre - dual->centre).norm(), 0, 1e-9);
  EXPECT_NEAR((direct->semiAxes - dual->semiAxes).norm(), 0, 1e-9);
  EXPECT_NEAR(direct->angle, dual->angle, 1e-11);
}

// Every tangent ray of the outline touches the ellipsoid: the quadratic of the ray has a double root.
TEST(Outline, RaysThroughItTouch) {
  const Ellipsoid q = general();
  const Outcome<Ellipse> e = outlineEllipse(q, lookAlongZ(800, 3));
  ASSERT_TRUE(e);
  const Eigen::Matrix3d w = q.shape().inverse();
  const Eigen::Vector3d o = Eigen::Vector3d(0, 0, -3) - q.centre();
  for (const Pixel& p : e->sample(12)) {
    const Eigen::Vector3d d((p.x() - 320) / 800, (p.y() - 240) / 800, 1);
    const double a = d.dot(w * d), b = d.dot(w * o), c = o.dot(w * o) - 1;
    EXPECT_NEAR(b * b / (a * c), 1, 1e-11);
  }
}

TEST(Outline, TinyAndFarKeepsItsDigits) {
  const Outcome<Ellipse> e = outlineEllipse(sphere(1e-6, {-20, 10, 100}), lookAlongZ(800.0, 0.0));
  ASSERT_TRUE(e);
  // Seen off axis at tan = sqrt(0.05): the cone of half angle R/d cuts the image in an ellipse of ratio cos(off-axis angle).
  EXPECT_NEAR(e->semiAxes.y() / e->semiAxes.x(), std::cos(std::atan(std::sqrt(0.05))), 1e-9);
}

TEST(Outline, DegenerateViewsAreNamed) {
  EXPECT_EQ(outlineEllipse(sphere(1, {0, 0, -5}), lookAlongZ(800, 0)).failure().reason, Reason::BehindCamera);
  EXPECT_EQ(outlineEllipse(sphere(1, {0, 0, 0.5}), lookAlongZ(800, 0)).failure().reason, Reason::NotAnEllipse);  // camera inside
  EXPECT_EQ(outlineEllipse(sphere(1, {5, 0, 0.5}), lookAlongZ(800, 0)).failure().reason,
            Reason::NotAnEllipse);                                                    // crosses the plane
  const Ellipsoid disc(Eigen::Isometry3d(Eigen::Translation3d(0, 0, 5)), {1, 0, 1});  // in the plane y = 0
  EXPECT_EQ(outlineEllipse(disc, lookAlongZ(800, 0)).failure().reason, Reason::NotAnEllipse);
  const Ellipsoid facing(Eigen::Isometry3d(Eigen::Translation3d(0, 0, 5)), {1, 0.5, 0});
  const Outcome<Ellipse> e = outlineEllipse(facing, lookAlongZ(800, 0));
  ASSERT_TRUE(e);
  EXPECT_NEAR(e->semiAxes.x(), 160, 1e-9);
  EXPECT_NEAR(e->semiAxes.y(), 80, 1e-9);
  EXPECT_EQ(e->angle, 0);
}

TEST(Ellipsoid, SortsItsAxesAndStaysRightHanded) {
  const Ellipsoid e(Eigen::Isometry3d::Identity(), {0.2, 0.5, 0.3});
  EXPECT_EQ(e.semiAxes(), Eigen::Vector3d(0.5, 0.3, 0.2));
  EXPECT_NEAR(e.worldFromBody().linear().determinant(), 1, kExact);
  EXPECT_NEAR((e.shape() - Eigen::Matrix3d(Eigen::Vector3d(0.04, 0.25, 0.09).asDiagonal())).norm(), 0, kExact);
}
TEST(Ellipsoid, RefusesWhatIsNone) {
  const Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  EXPECT_THROW(Ellipsoid(pose, {1, 1, -1}), std::invalid_argument);
  EXPECT_THROW(Ellipsoid(pose, {1, 0, 0}), std::invalid_argument);
  EXPECT_THROW(Ellipsoid(pose, {1, 1, NAN}), std::invalid_argument);
}

TEST(Ellipsoid, RoundTripsThroughDualAtEveryScale) {
  for (const double scale : {1e-6, 1e-3, 1.0, 1e3, 1e6}) {
    const Ellipsoid g = general();
    Eigen::Isometry3d pose = g.worldFromBody();
    pose.translation() *= scale;
    const Ellipsoid e(pose, scale * g.semiAxes());
    for (const double factor : {1.0, -1.0, 1e-9, 1e9}) {
      const Outcome<Ellipsoid> back = Ellipsoid::fromDual({factor * e.dual().matrix});
      ASSERT_TRUE(back) << scale << " " << factor;
      EXPECT_NEAR((back->semiAxes() - e.semiAxes()).norm() / scale, 0, kExact);
      EXPECT_NEAR((back->centre() - e.centre()).norm() / scale, 0, kExact);
      EXPECT_NEAR((back->shape() - e.shape()).norm() / (scale * scale), 0, kExact);
      EXPECT_STREQ(describe({factor * e.dual().matrix}), "ellipsoid");
    }
  }
}

struct EllipsoidCase {
  const char* description;
  Eigen::Vector4d diagonal;
  bool accepted;
  Signature signature;
};
std::ostream& operator<<(std::ostream& out, const EllipsoidCase& c) { return out << c.description; }
class QuadricKinds : public testing::TestWithParam<EllipsoidCase> {};
TEST_P(QuadricKinds, AreDescribedAndOnlyEllipsoidsAccepted) {
  Eigen::Matrix4d moved = Eigen::Matrix4d::Identity();
  moved.topRightCorner<3, 1>() << 0.5, -0.25, 2;
  for (const double scale : {1.0, 1e-12, 1e12, -1.0}) {
    const DualQuadric q{scale * (moved * GetParam().diagonal.asDiagonal() * moved.transpose())};
    EXPECT_STREQ(describe(q), GetParam().description) << scale;
    const Outcome<Ellipsoid> e = Ellipsoid::fromDual(q);
    EXPECT_EQ(bool(e), GetParam().accepted) << scale;
    if (!e) {
      EXPECT_EQ(e.failure().reason, Reason::NotAnEllipsoid) << scale;
    }
    if (GetParam().diagonal.w() == 0) continue;  // no sign to fix
    const Signature s = signatureOf(q);
    EXPECT_EQ(s.positive, GetParam().signature.positive);
    EXPECT_EQ(s.negative, GetParam().signature.negative);
    EXPECT_EQ(s.zero, GetParam().signature.zero);
  }
}
INSTANTIATE_TEST_SUITE_P(Ellipsoid, QuadricKinds,
                         testing::Values(EllipsoidCase{"ellipsoid", {-1, -2, -3, 1}, true, {1, 3, 0}},
                                         EllipsoidCase{"flat ellipsoid", {-1, -2, 0, 1}, true, {1, 2, 1}},
                                         EllipsoidCase{"segment", {-1, 0, 0, 1}, false, {1, 1, 2}},
                                         EllipsoidCase{"point", {0, 0, 0, 1}, false, {1, 0, 3}},
                                         EllipsoidCase{"hyperboloid of one sheet", {-1, -2, 3, 1}, false, {2, 2, 0}},
                                         EllipsoidCase{"hyperboloid of two sheets", {-1, 2, 3, 1}, false, {3, 1, 0}},
                                         EllipsoidCase{"imaginary ellipsoid", {1, 2, 3, 1}, false, {4, 0, 0}},
                                         EllipsoidCase{"flat hyperboloid", {-1, 2, 0, 1}, false, {2, 1, 1}},
                                         EllipsoidCase{"quadric at infinity", {1, 2, -3, 0}, false, {}}));

TEST(Ellipsoid, NotFiniteIsNamed) {
  EXPECT_EQ(Ellipsoid::fromDual({Eigen::Matrix4d::Constant(NAN)}).failure().reason, Reason::NotFinite);
  EXPECT_EQ(Ellipsoid::fromCentreAndShape({NAN, 0, 0}, Eigen::Matrix3d::Identity()).failure().reason, Reason::NotFinite);
  EXPECT_EQ(Ellipsoid::fromDual({Eigen::Matrix4d::Zero()}).failure().reason, Reason::NotAnEllipsoid);
}
TEST(Ellipsoid, RoundOffBelowZeroIsClamped) {
  const Eigen::Matrix3d flat = Eigen::Vector3d(1, 0.5, -1e-14).asDiagonal();
  const Outcome<Ellipsoid> e = Ellipsoid::fromCentreAndShape({0, 0, 0}, flat);
  ASSERT_TRUE(e);
  EXPECT_EQ(e->semiAxes().z(), 0);
  const Eigen::Matrix3d wrong = Eigen::Vector3d(1, 0.5, -1e-10).asDiagonal();
  EXPECT_EQ(Ellipsoid::fromCentreAndShape({0, 0, 0}, wrong).failure().reason, Reason::NotAnEllipsoid);
}

}  // namespace
}  // namespace glint
