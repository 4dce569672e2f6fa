// SPDX-License-Identifier: BSD-3-Clause
#include "core/surface/brightest_point.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/surface/mesh.h"
#include "tests/core/surface/surfaces.h"
#include "tests/tolerances.h"

namespace glint {
namespace {

using Eigen::Vector3d;

/// Alhazen's problem on a unit sphere around the origin by one unknown: the mirror point lies in the plane of eye and light at an
/// angle t from the eye; equal angles with the normal. Bisection in long double.
Vector3d mirrorPointOnSphere(const Vector3d& eye, const Vector3d& light, double radius) {
  const Vector3d u = eye.normalized(), w = (light - light.dot(u) * u).normalized();
  const long double e = eye.norm(), lx = light.dot(u), ly = light.dot(w), r = radius;
  const auto mismatch = [&](long double t) {
    const long double nx = std::cos(t), ny = std::sin(t), px = r * nx, py = r * ny;
    const auto angle = [&](long double x, long double y) {
      return std::atan2(nx * (y - py) - ny * (x - px), nx * (x - px) + ny * (y - py));
    };
    return angle(e, 0) + angle(lx, ly);
  };
  long double a = 0, b = std::atan2(ly, lx);
  const bool rising = mismatch(b) > mismatch(a);
  for (int i = 0; i < 200; ++i) {
    const long double m = 0.5L * (a + b);
    ((mismatch(m) < 0) == rising ? a : b) = m;
  }
  return radius * (std::cos(static_cast<double>(a)) * u + std::sin(static_cast<double>(a)) * w);
}

TEST(BrightestPoint, SphereAgreesWithAlhazen) {
  const auto sphere = makeAnalytic(test::sphere(0.4));
  std::mt19937 rng(11);
  std::uniform_real_distribution<double> u(-1, 1);
  for (int i = 0; i < 50; ++i) {
    const Vector3d eye = 2 * Vector3d(u(rng), u(rng), u(rng)).normalized();
    Vector3d light = 3 * Vector3d(u(rng), u(rng), u(rng)).normalized();
    if (light.dot(eye) < 0) light = -light;
    const Camera camera = test::lookAt(eye, {0, 0, 0}, 700);
    const auto found = predictedBrightestPoints(*sphere, camera, Light::at(light));
    ASSERT_TRUE(found) << found.failure().message();
    ASSERT_EQ(found->size(), 1u);
    EXPECT_NEAR(((*found)[0].point.position - mirrorPointOnSphere(eye, light, 0.4)).norm(), 0, 1e-14);
    EXPECT_LT((*found)[0].alpha, 1e-14);
    EXPECT_NEAR(((*found)[0].pixel - *camera.project((*found)[0].point.position)).norm(), 0, 1e-12);
  }
}

/// Where eye and light are as far from the centre, the mirror point bisects their directions: known without a search, and nothing
/// in it grows with the distance of all three from the origin.
TEST(BrightestPoint, IsFoundFarFromTheOriginAsWellAsCoordinatesTell) {
  const double half = 0.4;
  const Vector3d eye(3 * std::sin(half), 0, 3 * std::cos(half)), light(-eye.x(), 0, eye.z()), top(0, 0, 1);
  for (const double distance : {0.0, 1e6, 1e8, 1e9}) {
    SCOPED_TRACE(distance);
    const Vector3d origin = distance * Vector3d(1, -0.3, 0.2);
    AnalyticSpec spec = test::sphere(1);
    spec.worldFromSurface.translation() = origin;
    const auto sphere = makeAnalytic(spec);
    const auto found = predictedBrightestPoints(*sphere, test::lookAt(origin + eye, origin, 700), Light::at(origin + light));
    ASSERT_TRUE(found) << found.failure().message();
    ASSERT_EQ(found->size(), 1u);
    // A step of the coordinates at 1e9 is 1.2e-7 m.
    EXPECT_NEAR(((*found)[0].point.position - origin - top).norm(), 0, 1e-10 + 10 * 2.2e-16 * distance);
  }
}

TEST(BrightestPoint, LightAtInfinityOnSphereBisectsTheAngle) {
  // From very far away V is constant too: N = unit(L + V).
  const auto sphere = makeAnalytic(test::sphere(1));
  const Camera camera = test::lookAt({0, -2e6, 0}, {0, 0, 0}, 2e8);
  const Vector3d l = Vector3d(1, -1, 0.5).normalized();
  const auto found = predictedBrightestPoints(*sphere, camera, Light::towards(l));
  ASSERT_TRUE(found) << found.failure().message();
  EXPECT_NEAR(((*found)[0].point.normal - (l + Vector3d(0, -1, 0)).normalized()).norm(), 0, 1e-6);
  // And the limit of far lights is the light at infinity.
  const Camera near = test::lookAt({0, -3, 0}, {0, 0, 0});
  const auto far = predictedBrightestPoints(*sphere, near, Light::at(1e12 * l)),
             infinite = predictedBrightestPoints(*sphere, near, Light::towards(l));
  ASSERT_TRUE(far && infinite);
  EXPECT_NEAR(((*far)[0].point.position - (*infinite)[0].point.position).norm(), 0, 1e-11);
}

TEST(BrightestPoint, PlaneMirrorsTheLight) {
  AnalyticSpec spec = test::plane();
  spec.worldFromSurface = test::pose(0.2, {0, 0, 0.1});
  const auto plane = makeAnalytic(spec);
  const Vector3d n = spec.worldFromSurface.linear().col(2), o = spec.worldFromSurface.translation();
  const Vector3d eye(0.4, -1, 2), light(0.3, 0.8, 1.5);
  const auto found = predictedBrightestPoints(*plane, test::lookAt(eye, {0, 0, 0}), Light::at(light));
  ASSERT_TRUE(found) << found.failure().message();
  const Vector3d image = light - 2 * n.dot(light - o) * n;
  const double t = n.dot(o - eye) / n.dot(image - eye);
  EXPECT_NEAR(((*found)[0].point.position - (eye + t * (image - eye))).norm(), 0, 1e-15);
}

/// The valley of the half angle is a thousand times longer than wide here: a search without derivatives ended on its way.
TEST(BrightestPoint, FlatFacetsMirrorTheLightAtGrazingAngles) {
  AnalyticSpec sheet;
  sheet.type = "sheet";
  sheet.length = sheet.width = 1.2;
  const auto facets = makeMesh(makeAnalytic(sheet)->tessellate({}, 12), NormalPolicy::Facet);
  for (const double degrees : {80.0, 85.0, 89.0, 89.9}) {
    const double a = degrees * M_PI / 180;
    const Vector3d eye(-0.8 * std::sin(a), 0.03, 0.8 * std::cos(a)), light(2 * std::sin(a), -0.07, 2 * std::cos(a));
    const auto found = predictedBrightestPoints(*facets, test::lookAt(eye, {0, 0, 0}), Light::at(light));
    ASSERT_TRUE(found) << degrees << " degrees: " << found.failure().message();
    // The light's image is below the plane z = 0.
    const double t = eye.z() / (eye.z() + light.z());
    const Vector3d expected(eye.x() + t * (light.x() - eye.x()), eye.y() + t * (light.y() - eye.y()), 0);
    // A tilt of round-off shifts the point by its distance over the cosine.
    EXPECT_NEAR(((*found)[0].point.position - expected).norm(), 0, 1e-15 / std::cos(a)) << degrees << " degrees";
  }
}

TEST(BrightestPoint, ConcaveSphereHasSeveral) {
  // Inside a sphere, eye and light on a diameter at -d and +d: for d > r/2 ... the two points of the diameter's plane section
  // and whole circles. A slanted light leaves isolated ones; a dense search over the sphere counts them.
  const auto sphere = makeAnalytic(test::sphere(1));
  const Vector3d eye(0, -0.6, 0.1), light(0.2, 0.5, 0.15);
  Camera camera = test::lookAt(eye, {0, 1, 0}, 250);
  const auto found = predictedBrightestPoints(*sphere, camera, Light::at(light));
  ASSERT_TRUE(found) << found.failure().message();
  for (const BrightestPoint& b : *found) {
    EXPECT_LT(b.alpha, 1e-13);
    EXPECT_NEAR(b.point.position.norm(), 1, 1e-14);
  }
  // Independent count: solutions lie in the plane of centre, eye and light (off it the reflected ray leaves it); one angle.
  const Vector3d u = eye.normalized(), w = (light - light.dot(u) * u).normalized();
  int expected = 0;
  const auto mismatch = [&](double t) {
    const Vector3d p = std::cos(t) * u + std::sin(t) * w, n = -p, a = (eye - p).normalized(), b = (light - p).normalized();
    const Vector3d tangent = -std::sin(t) * u + std::cos(t) * w;
    (void)n;
    return (a + b).dot(tangent);
  };
  for (int i = 0; i < 100000; ++i) {
    const double t0 = 2 * M_PI * i / 100000, t1 = 2 * M_PI * (i + 1) / 100000;
    if (mismatch(t0) * mismatch(t1) > 0) continue;
    const Vector3d p = std::cos(t0) * u + std::sin(t0) * w;
    const auto pixel = camera.project(p);
    if (pixel && pixel->x() > -64 && pixel->x() < 704 && pixel->y() > -48 && pixel->y() < 528) ++expected;
  }
  EXPECT_GE(expected, 1);
  EXPECT_EQ(static_cast<int>(found->size()), expected);
}

TEST(BrightestPoint, TorusFindsAllOfADenseSearch) {
  const auto torus = makeAnalytic(test::torus(0.5, 0.2));
  std::mt19937 rng(5);
  std::uniform_real_distribution<double> u(-1, 1);
  int several = 0;
  for (int i = 0; i < 12; ++i) {
    const Vector3d eye = Vector3d(u(rng), u(rng), 1.5 + u(rng)), light(2 * u(rng), 2 * u(rng), 2 + u(rng));
    const Camera camera = test::lookAt(eye, {0, 0, 0}, 500);
    const auto found = predictedBrightestPoints(*torus, camera, Light::at(light));
    BrightestPointOptions dense;
    dense.seedStepPx = 2;
    const auto all = predictedBrightestPoints(*torus, camera, Light::at(light), dense);
    ASSERT_EQ(static_cast<bool>(found), static_cast<bool>(all));
    if (!found) continue;
    EXPECT_EQ(found->size(), all->size()) << i;
    if (found->size() > 1) ++several;
    for (const BrightestPoint& b : *found) {
      const Vector3d v = (eye - b.point.position).normalized(), l = (light - b.point.position).normalized();
      EXPECT_NEAR((reflect(v, b.point.normal) - l).norm(), 0, 1e-12);  // the law itself
      EXPECT_FALSE(torus->firstHit({eye, -v}) && (torus->firstHit({eye, -v})->position - b.point.position).norm() > 1e-9);
    }
  }
  EXPECT_GT(several, 2);
}

TEST(BrightestPoint, SaysWhyThereIsNone) {
  const auto detail = [](const Surface& s, const Camera& c, const Light& l) {
    const auto found = predictedBrightestPoints(s, c, l);
    EXPECT_FALSE(found);
    if (found) return std::string("found");
    EXPECT_EQ(found.failure().reason, Reason::NoBrightestPoint);
    return found.failure().detail;
  };
  const auto sheet = makeAnalytic(test::sheet(0, 1.0, 1.0));
  const Camera camera = test::lookAt({0, -0.5, 2}, {0, 0, 0});
  EXPECT_NE(detail(*sheet, camera, Light::at({3, 0, 2})).find("edge"), std::string::npos);
  EXPECT_NE(detail(*sheet, camera, Light::at({0, 0.2, -2})).find("n"), std::string::npos);
  EXPECT_NE(detail(*makeAnalytic(test::sphere(0.4)), test::lookAt({0, -2, 0}, {0, -4, 0}), Light::at({0, -3, 3}))
                .find("off the surface"),
            std::string::npos);
  // The rear half of a torus hides the mirror point of a light below it.
  EXPECT_FALSE(predictedBrightestPoints(*makeAnalytic(test::sphere(0.4)), test::lookAt({0, -2, 0}, {0, 0, 0}),
                                        Light::at({0.0, 2.0, 0.1})));
}

TEST(BrightestPoint, HintsAloneAreEnough) {
  const auto sphere = makeAnalytic(test::sphere(0.4));
  const Camera camera = test::lookAt({0, -2, 0.3}, {0, 0, 0});
  const Light light = Light::at({1, -2, 2});
  const auto full = predictedBrightestPoints(*sphere, camera, light);
  ASSERT_TRUE(full);
  BrightestPointOptions options;
  options.hintsOnly = true;
  options.hints = {(*full)[0].point.position + Vector3d(0.05, 0, 0.02)};
  const auto hinted = predictedBrightestPoints(*sphere, camera, light, options);
  ASSERT_TRUE(hinted);
  EXPECT_NEAR(((*hinted)[0].pixel - (*full)[0].pixel).norm(), 0, 1e-9);
  options.hints.clear();
  EXPECT_FALSE(predictedBrightestPoints(*sphere, camera, light, options));
}

TEST(BrightestPoint, SmallSurfaceInTheImageIsFound) {
  const auto sphere = makeAnalytic(test::sphere(0.01));  // 8 px across
  const Vector3d eye(0.3, -2, 0.2), light(1, -1, 2);
  const auto found = predictedBrightestPoints(*sphere, test::lookAt(eye, {0.1, 0, 0}), Light::at(light));
  ASSERT_TRUE(found) << found.failure().message();
  EXPECT_NEAR(((*found)[0].point.position - mirrorPointOnSphere(eye, light, 0.01)).norm(), 0, 1e-14);
}

TEST(BrightestPoint, RigidMotionAndScale) {
  const Vector3d eye(0.4, -1.2, 1.5), light(0.8, 0.9, 2.0);
  AnalyticSpec spec = test::ellipsoid(0.6, 0.35, 0.25);
  const Camera camera = test::lookAt(eye, {0, 0, 0});
  const auto base = predictedBrightestPoints(*makeAnalytic(spec), camera, Light::at(light));
  ASSERT_TRUE(base);
  const Eigen::Isometry3d m = test::pose(0.9, {0.5, -0.3, 0.7});
  for (const double s : {1e-3, 1.0, 1e3}) {
    AnalyticSpec moved = spec;
    moved.semiAxes *= s;
    moved.worldFromSurface = m;
    moved.worldFromSurface.translation() *= s;
    Camera c = camera;
    c.camFromWorld.translation() *= s;
    Eigen::Isometry3d scaledMotion = m;
    scaledMotion.translation() *= s;
    c.camFromWorld = c.camFromWorld * scaledMotion.inverse();
    const auto found = predictedBrightestPoints(*makeAnalytic(moved), c, Light::at(scaledMotion * Vector3d(s * light)));
    ASSERT_TRUE(found) << s;
    ASSERT_EQ(found->size(), base->size());
    EXPECT_NEAR(((*found)[0].pixel - (*base)[0].pixel).norm(), 0, 1e-9) << s;
  }
}

TEST(BrightestPoint, Observed) {
  const auto sphere = makeAnalytic(test::sphere(0.4));
  const Camera camera = test::lookAt({0, -2, 0}, {0, 0, 0});
  const auto hit = observedBrightestPoint(*sphere, camera, {319.5, 239.5});
  ASSERT_TRUE(hit);
  EXPECT_NEAR((hit->point.position - Vector3d(0, -0.4, 0)).norm(), 0, 1e-15);
  EXPECT_LT(hit->point.normal.y(), 0);
  EXPECT_EQ(observedBrightestPoint(*sphere, camera, {0, 0}).failure().reason, Reason::PeakOffSurface);
  EXPECT_EQ(observedBrightestPoint(*sphere, camera, {std::nan(""), 0}).failure().reason, Reason::NotFinite);
}

}  // namespace
}  // namespace glint
