// SPDX-License-Identifier: BSD-3-Clause
#include "core/geometry/conic.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/tolerances.h"

namespace glint {
namespace {
using tolerance::kExact;

Eigen::Matrix3d diag(double a, double b, double c) { return Eigen::Vector3d(a, b, c).asDiagonal(); }

/// y = x^2, as -2 x^2 ... + 2 y: rank 3, upper block singular.
Eigen::Matrix3d parabola() { return Eigen::Matrix3d{{1, 0, 0}, {0, 0, -0.5}, {0, -0.5, 0}}; }

/// Pixel translation of a point conic: x -> x + t.
Eigen::Matrix3d moved(const Eigen::Matrix3d& conic, double tx, double ty) {
  Eigen::Matrix3d back = Eigen::Matrix3d::Identity();
  back(0, 2) = -tx;
  back(1, 2) = -ty;
  return back.transpose() * conic * back;
}

struct ConicCase {
  const char* name;
  Eigen::Matrix3d conic;
  Reason expected;
};
std::ostream& operator<<(std::ostream& out, const ConicCase& c) { return out << c.name; }

class DegenerateConic : public testing::TestWithParam<ConicCase> {};

TEST_P(DegenerateConic, IsRefusedByNameAtEveryScaleAndSign) {
  for (const double scale : {1.0, 1e-12, 1e12, -1.0, -1e-12, 1e-300, 1e300}) {
    const Outcome<Ellipse> e = toEllipse(Conic{scale * GetParam().conic});
    ASSERT_FALSE(e) << scale;
    EXPECT_EQ(e.failure().reason, GetParam().expected) << scale << " " << e.failure().message();
  }
}

TEST_P(DegenerateConic, IsRefusedAwayFromTheOrigin) {
  const Outcome<Ellipse> e = toEllipse(Conic{moved(GetParam().conic, 640, -480)});
  ASSERT_FALSE(e);
  EXPECT_EQ(e.failure().reason, GetParam().expected) << e.failure().message();
}

INSTANTIATE_TEST_SUITE_P(Conic, DegenerateConic,
                         testing::Values(ConicCase{"two crossing lines", diag(1, -1, 0), Reason::RankDeficient},
                                         ConicCase{"double line", diag(1, 0, 0), Reason::RankDeficient},
                                         ConicCase{"parallel lines", diag(1, 0, -1), Reason::RankDeficient},
                                         ConicCase{"single point", diag(1, 1, 0), Reason::RankDeficient},
                                         ConicCase{"imaginary ellipse", diag(1, 1, 1), Reason::NotAnEllipse},
                                         ConicCase{"hyperbola", diag(1, -1, -1), Reason::NotAnEllipse},
                                         ConicCase{"hyperbola, other side", diag(1, -1, 1), Reason::NotAnEllipse},
                                         ConicCase{"parabola", parabola(), Reason::NotAnEllipse}));

TEST(ToEllipse, RefusesZeroAndNotFinite) {
  EXPECT_EQ(toEllipse(Conic{Eigen::Matrix3d::Zero()}).failure().reason, Reason::RankDeficient);
  EXPECT_EQ(toEllipse(Conic{diag(1, 1, std::nan(""))}).failure().reason, Reason::NotFinite);
  EXPECT_EQ(toEllipse(DualConic{diag(1, INFINITY, -1)}).failure().reason, Reason::NotFinite);
  EXPECT_EQ(dualOf(Conic{diag(1, -1, 0)}).failure().reason, Reason::RankDeficient);
  EXPECT_EQ(conicOf(DualConic{diag(1, -1, 0)}).failure().reason, Reason::RankDeficient);
  EXPECT_EQ(dualOf(Conic{diag(1, NAN, 0)}).failure().reason, Reason::NotFinite);
}

TEST(ToEllipse, DualOfDegenerateKindsIsNamed) {
  EXPECT_EQ(toEllipse(DualConic{diag(-1, 1, 1)}).failure().reason, Reason::NotAnEllipse);   // hyperbola
  EXPECT_EQ(toEllipse(DualConic{diag(1, 1, 1)}).failure().reason, Reason::NotAnEllipse);    // imaginary
  EXPECT_EQ(toEllipse(DualConic{parabola()}).failure().reason, Reason::NotAnEllipse);       // (2,2) == 0
  EXPECT_EQ(toEllipse(DualConic{diag(-1, 0, 1)}).failure().reason, Reason::RankDeficient);  // a segment
}

// Closed form: (x/3)^2 + (y/2)^2 = 1 turned by 30 degrees about (5, -7).
TEST(Ellipse, ConicHoldsItsPointsAndCentreIsMinusOne) {
  const Ellipse e{{5, -7}, {3, 2}, std::numbers::pi / 6};
  const Conic c = e.conic();
  EXPECT_NEAR(e.centre.homogeneous().dot(c.matrix * e.centre.homogeneous()), -1.0, kExact);
  const Pixel tip(5 + 3 * std::cos(std::numbers::pi / 6), -7 + 3 * std::sin(std::numbers::pi / 6));
  EXPECT_NEAR(tip.homogeneous().dot(c.matrix * tip.homogeneous()), 0.0, 1e-11);
  EXPECT_NEAR((e.at(0) - tip).norm(), 0, kExact);
  const Pixel side(5 - 2 * std::sin(std::numbers::pi / 6), -7 + 2 * std::cos(std::numbers::pi / 6));
  EXPECT_NEAR((e.at(std::numbers::pi / 2) - side).norm(), 0, kExact);
  EXPECT_NEAR(e.area(), 6 * std::numbers::pi, kExact);
}

TEST(Ellipse, DualHoldsItsTangents) {
  const Ellipse e{{5, -7}, {3, 2}, 0.3};
  for (const double t : {0.0, 1.0, 2.5, 4.0}) {
    const Eigen::Vector3d tangent = e.conic().matrix * e.at(t).homogeneous();
    EXPECT_NEAR(tangent.dot(e.dual().matrix * tangent) / tangent.squaredNorm(), 0.0, 1e-11);
  }
}

TEST(Ellipse, RoundTripsThroughBothMatricesAtAnyScaleAndSign) {
  for (const Ellipse& e :
       {Ellipse{{320, 240}, {100, 40}, 0.7}, Ellipse{{-3e4, 5e4}, {1.5, 0.5}, -1.2}, Ellipse{{0, 0}, {1e-4, 1e-5}, 1.5},
        Ellipse{{10, 20}, {1e6, 2e5}, std::numbers::pi / 2}, Ellipse{{320, 240}, {100, 0.1}, -0.4}}) {
    // What the entries of a conic can hold: the constant term is (|centre| / axis)^2 times larger than the 1 in it.
    const double lost = std::pow(1 + e.centre.norm() / e.semiAxes.y(), 2) * 1e-14;
    for (const double scale : {1.0, -1.0, 1e-200, 1e200}) {
      const Outcome<Ellipse> a = toEllipse(Conic{scale * e.conic().matrix});
      const Outcome<Ellipse> b = toEllipse(DualConic{scale * e.dual().matrix});
      for (const Outcome<Ellipse>& back : {a, b}) {
        ASSERT_TRUE(back) << back.failure().message();
        EXPECT_NEAR(back->semiAxes.x() / e.semiAxes.x(), 1, 1e-12 + lost);
        EXPECT_NEAR(back->semiAxes.y() / e.semiAxes.y(), 1, 1e-12 + lost);
        EXPECT_NEAR((back->centre - e.centre).norm() / e.semiAxes.x(), 0, 1e-12 + lost);
        EXPECT_NEAR(std::remainder(back->angle - e.angle, std::numbers::pi), 0, 1e-9 + lost);
        EXPECT_GT(back->angle, -std::numbers::pi / 2);
        EXPECT_LE(back->angle, std::numbers::pi / 2);
      }
    }
  }
}

TEST(DualOf, IsTheInverseAndKeepsTheInteriorNegative) {
  const Ellipse e{{50, 80}, {30, 20}, 0.4};
  const Outcome<DualConic> dual = dualOf(e.conic());
  ASSERT_TRUE(dual);
  const Eigen::Matrix3d product = dual->matrix * e.conic().matrix;
  EXPECT_NEAR((product / product(0, 0) - Eigen::Matrix3d::Identity()).norm(), 0, 1e-9);
  for (const double sign : {1.0, -1.0}) {
    const Outcome<Conic> back = conicOf(DualConic{sign * dual->matrix});
    ASSERT_TRUE(back);
    EXPECT_LT(e.centre.homogeneous().dot(back->matrix * e.centre.homogeneous()), 0);
  }
}

TEST(Ellipse, SampleDoesNotRepeatTheFirstPoint) {
  const Ellipse e{{1, 2}, {4, 3}, 0.2};
  const std::vector<Pixel> points = e.sample(8);
  ASSERT_EQ(points.size(), 8u);
  EXPECT_NEAR((points[0] - e.at(0)).norm(), 0, kExact);
  EXPECT_NEAR((points[4] - e.at(std::numbers::pi)).norm(), 0, kExact);
}

// Closed form: from (d, 0) the tangents of the unit circle touch at (1/d, +- sqrt(1 - 1/d^2)).
TEST(TangentLines, OfACircle) {
  const Conic circle{diag(1, 1, -1)};
  const auto lines = tangentLines(circle, {2, 0, 1});
  ASSERT_TRUE(lines);
  for (const Eigen::Vector3d& l : *lines) {
    EXPECT_NEAR(l.head<2>().norm(), 1, kExact);
    EXPECT_NEAR(l.dot(Eigen::Vector3d(2, 0, 1)), 0, kExact);
    EXPECT_NEAR(std::abs(l.z()), 1.0, kExact);  // distance 1 from the centre
    EXPECT_NEAR(std::abs(l.x()), 0.5, kExact);
  }
  EXPECT_GT(((*lines)[0] - (*lines)[1]).norm(), 0.5);
  EXPECT_EQ(tangentLines(circle, {0.5, 0, 1}).failure().reason, Reason::NotAnEllipse);
  EXPECT_EQ(tangentLines(circle, {0, 0, 1}).failure().reason, Reason::NotAnEllipse);
}

TEST(TangentLines, FromInfinityAreParallelAndTouch) {
  const Ellipse e{{100, 50}, {30, 10}, 0.5};
  const auto lines = tangentLines(e.conic(), {1, 2, 0});
  ASSERT_TRUE(lines);
  for (const Eigen::Vector3d& l : *lines) {
    EXPECT_NEAR(l.dot(Eigen::Vector3d(1, 2, 0)), 0, kExact);
    EXPECT_NEAR(l.dot(e.dual().matrix * l), 0, 1e-8);  // on entries of order 1e4
  }
}

}  // namespace
}  // namespace glint
