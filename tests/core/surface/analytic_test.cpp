// SPDX-License-Identifier: BSD-3-Clause
#include "core/surface/analytic.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <utility>

#include "tests/core/surface/surfaces.h"
#include "tests/tolerances.h"

namespace glint {
namespace {

using Eigen::Vector3d;

struct Row {
  const char* name;
  AnalyticSpec spec;
  double (*implicit)(const Vector3d&);  ///< of the local frame, written independently of the implementation
};

std::vector<Row> rows() {
  return {
      {"plane", test::plane(), [](const Vector3d& p) { return p.z(); }},
      {"sphere", test::sphere(0.4), [](const Vector3d& p) { return p.norm() - 0.4; }},
      {"ellipsoid", test::ellipsoid(0.6, 0.35, 0.25),
       [](const Vector3d& p) { return std::sqrt(p.x() * p.x() / 0.36 + p.y() * p.y() / 0.1225 + p.z() * p.z() / 0.0625) - 1; }},
      {"cylinder", test::cylinder(0.3), [](const Vector3d& p) { return std::hypot(p.x(), p.z()) - 0.3; }},
      {"sheet", test::sheet(2.0), [](const Vector3d& p) { return std::hypot(p.x(), p.z() + 0.5) - 0.5; }},
      {"concave sheet", test::sheet(-2.0), [](const Vector3d& p) { return std::hypot(p.x(), p.z() - 0.5) - 0.5; }},
      {"torus", test::torus(0.5, 0.2), [](const Vector3d& p) { return std::hypot(std::hypot(p.x(), p.y()) - 0.5, p.z()) - 0.2; }},
      {"quadric", test::saddle(), [](const Vector3d& p) { return p.x() * p.x() - p.y() * p.y() + p.z(); }},
  };
}

/// First sign change of the implicit function along a ray, by dense sampling and bisection. A tangent touch is not found.
std::optional<double> firstRoot(double (*f)(const Vector3d&), const Vector3d& o, const Vector3d& d, double far) {
  const int n = 20000;
  double before = f(o);
  for (int i = 1; i <= n; ++i) {
    double a = far * (i - 1) / n, b = far * i / n;
    const double here = f(o + b * d);
    if (before * here < 0) {
      for (int k = 0; k < 80; ++k) {
        const double m = 0.5 * (a + b);
        (f(o + m * d) * before > 0 ? a : b) = m;
      }
      return 0.5 * (a + b);
    }
    before = here;
  }
  return std::nullopt;
}

TEST(Analytic, FirstHitMatchesSignChangeOfTheImplicitFunction) {
  std::mt19937 rng(7);
  std::uniform_real_distribution<double> u(-1, 1);
  for (Row row : rows()) {
    row.spec.worldFromSurface = test::pose(0.3, {0.1, -0.2, 0.3});
    const auto surface = makeAnalytic(row.spec);
    int hits = 0, misses = 0;
    for (int i = 0; i < 60; ++i) {
      const Vector3d o = 1.5 * Vector3d(u(rng), u(rng), u(rng)).normalized(), target = 0.5 * Vector3d(u(rng), u(rng), u(rng));
      const Vector3d d = (target - o).normalized();
      const std::optional<double> t = firstRoot(row.implicit, o, d, 6);
      const Eigen::Isometry3d& m = row.spec.worldFromSurface;
      const Outcome<SurfacePoint> hit = surface->firstHit({m * o, m.linear() * d});
      if (!t) {
        ++misses;
        if (hit) {  // a touch or beyond the sampled part
          EXPECT_GT((hit->position - m * o).norm(), 0.5) << row.name;
        }
        continue;
      }
      ++hits;
      ASSERT_TRUE(hit) << row.name;
      EXPECT_NEAR((hit->position - m * (o + *t * d)).norm(), 0, 1e-11) << row.name;  // conditioning of slanted rays
      EXPECT_NEAR(hit->normal.norm(), 1, tolerance::kExact);
    }
    EXPECT_GT(hits, 10) << row.name;
  }
}

TEST(Analytic, FootIsTheRootNearestToPreviousForBothSigns) {
  const auto sphere = makeAnalytic(test::sphere(1));
  SurfacePoint top;
  top.position = {0, 0, 1};
  for (const double z : {-5.0, -1.5, 0.0, 0.5, 1.5, 40.0})
    for (const double sign : {-1.0, 1.0}) {
      const Outcome<SurfacePoint> foot = sphere->foot({0.6, 0, z}, {0, 0, sign}, top);
      ASSERT_TRUE(foot);
      EXPECT_NEAR((foot->position - Vector3d(0.6, 0, 0.8)).norm(), 0, 1e-14);
      EXPECT_NEAR((foot->normal - Vector3d(0.6, 0, 0.8)).norm(), 0, 1e-14);
    }
  EXPECT_EQ(sphere->foot({1.1, 0, 0}, {0, 0, 1}, top).failure().reason, Reason::SurfaceEnded);
}

TEST(Analytic, CurvatureMatchesDifferencesOfTheNormalField) {
  std::mt19937 rng(3);
  std::uniform_real_distribution<double> u(-1, 1);
  for (Row row : rows()) {
    row.spec.worldFromSurface = test::pose(1.1, {0.3, 0.1, -0.2});
    const auto surface = makeAnalytic(row.spec);
    int tested = 0;
    for (int i = 0; i < 40; ++i) {
      const Eigen::Isometry3d& m = row.spec.worldFromSurface;
      const Vector3d o = 1.5 * Vector3d(u(rng), u(rng), u(rng)).normalized(), target = 0.3 * Vector3d(u(rng), u(rng), u(rng));
      const Outcome<SurfacePoint> p = surface->firstHit({m * o, m.linear() * (target - o).normalized()});
      if (!p) continue;
      const Outcome<Curvature> c = surface->curvatureAt(*p);
      ASSERT_TRUE(c) << row.name;
      EXPECT_GE(c->k1, c->k2);
      EXPECT_NEAR(c->direction1.dot(c->direction2), 0, 1e-12);
      const double h = 1e-5;
      for (const auto& [k, direction] : {std::pair{c->k1, c->direction1}, std::pair{c->k2, c->direction2}}) {
        const Outcome<SurfacePoint> a = surface->foot(p->position - h * direction, p->normal, *p);
        const Outcome<SurfacePoint> b = surface->foot(p->position + h * direction, p->normal, *p);
        ASSERT_TRUE(a && b) << row.name;
        // Central differences at h = 1e-5: h^2 times third derivatives of order 1e3, plus round-off 1e-16 / h.
        EXPECT_NEAR(((b->normal - a->normal) / (2 * h) - k * direction).norm(), 0, 2e-6) << row.name;
      }
      ++tested;
    }
    EXPECT_GT(tested, 10) << row.name;
  }
}

TEST(Analytic, TorusCurvaturesInClosedForm) {
  const auto torus = makeAnalytic(test::torus(0.5, 0.2));
  const Outcome<SurfacePoint> outer = torus->firstHit({{2, 0, 0}, {-1, 0, 0}});
  ASSERT_TRUE(outer);
  EXPECT_NEAR(torus->curvatureAt(*outer)->k1, 1 / 0.2, 1e-12);
  EXPECT_NEAR(torus->curvatureAt(*outer)->k2, 1 / 0.7, 1e-12);
  const Outcome<SurfacePoint> inner = torus->firstHit({{0, 0, 0}, {-1, 0, 0}});
  ASSERT_TRUE(inner);
  EXPECT_NEAR(inner->position.x(), -0.3, 1e-15);
  EXPECT_NEAR(torus->curvatureAt(*inner)->k2, -1 / 0.3, 1e-12);
  // All four crossings, one after the other.
  Vector3d from(-1, 0.01, 0.02);
  for (const double q : {0.7, 0.3, 0.3, 0.7}) {
    const Outcome<SurfacePoint> hit = torus->firstHit({from, {1, 0, 0}});
    ASSERT_TRUE(hit);
    EXPECT_NEAR(std::abs(hit->position.x()), q, 2e-3);
    from = hit->position + Vector3d(1e-9, 0, 0);
  }
  EXPECT_FALSE(torus->firstHit({from, {1, 0, 0}}));
}

TEST(Analytic, SheetIsSmoothThroughZeroCurvature) {
  // z(x) = -k x^2 / 2 + O(k^3): the same to 1e-15 whatever branch computes it, down to denormal curvature.
  for (const double k : {0.0, 1e-320, 1e-200, 1e-16, 1e-12, 1e-9, 1e-8, 1e-6, -1e-12, -1e-9, -1e-6}) {
    const auto sheet = makeAnalytic(test::sheet(k, 1.0, 1.0));
    for (const double x : {0.0, 0.1, 0.4999}) {
      const Outcome<SurfacePoint> hit = sheet->firstHit({{x, 0.2, 3}, {0, 0, -1}});
      ASSERT_TRUE(hit) << k;
      EXPECT_NEAR(hit->position.z(), -0.5 * k * x * x, 4e-16) << k;
      EXPECT_NEAR(hit->normal.x(), k * x, 4e-16) << k;
      EXPECT_NEAR(sheet->curvatureAt(*hit)->k1 + sheet->curvatureAt(*hit)->k2, k, 1e-15) << k;
    }
    EXPECT_FALSE(sheet->firstHit({{0.5001, 0.2, 3}, {0, 0, -1}})) << k;
    EXPECT_FALSE(sheet->firstHit({{0.1, 0.5001, 3}, {0, 0, -1}})) << k;
  }
}

TEST(Analytic, SheetEndsAtItsArcLength) {
  const double k = 2.0, length = 1.2;
  const auto sheet = makeAnalytic(test::sheet(k, length, 0.5));
  for (const double s : {0.5 * length - 1e-9, 0.5 * length + 1e-9}) {
    const Vector3d p(std::sin(k * s) / k, 0.1, (std::cos(k * s) - 1) / k), n(std::sin(k * s), 0, std::cos(k * s));
    EXPECT_EQ(static_cast<bool>(sheet->firstHit({p + n, -n})), s < 0.5 * length);
    SurfacePoint previous;
    previous.position = p;
    const Outcome<SurfacePoint> foot = sheet->foot(p + 0.3 * n, n, previous);
    EXPECT_EQ(static_cast<bool>(foot), s < 0.5 * length);
    if (!foot) {
      EXPECT_EQ(foot.failure().reason, Reason::SurfaceEnded);
    }
  }
  const Eigen::AlignedBox3d box = sheet->bounds();
  EXPECT_NEAR(box.max().x(), 0.5 * std::sin(1.2), 1e-3);
  EXPECT_NEAR(box.max().y(), 0.25, 1e-15);
}

TEST(Analytic, SpeaksOfOcclusionOnBothSides) {
  const auto sphere = makeAnalytic(test::sphere(1));
  SurfacePoint p;
  p.position = {0.6, 0, 0.8};
  EXPECT_FALSE(sphere->occluded(p, {3, 0, 4}));
  EXPECT_TRUE(sphere->occluded(p, {-3, 0, -4}));
  EXPECT_FALSE(
      sphere->occluded(p, Vector3d(0.6, 0, 0.8) + 10 * Vector3d(0.8, 0, -0.6) + Vector3d(1e-3, 0, 1e-3)));  // almost tangent
  const auto torus = makeAnalytic(test::torus(0.5, 0.2));
  p.position = {-0.3, 0, 0};
  EXPECT_FALSE(torus->occluded(p, {0.2, 0, 0}));
  EXPECT_TRUE(torus->occluded(p, {0.4, 0, 0}));
}

TEST(Analytic, GrazingRaysKeepTheirDigits) {
  // A ray at impact parameter b from 1000 radii away: entry at x = -sqrt(1 - b^2), here by long double.
  const auto sphere = makeAnalytic(test::sphere(1));
  for (const long double gap : {1e-3L, 1e-6L, 1e-9L}) {
    const double b = static_cast<double>(1 - gap);
    const long double x = -std::sqrt(1 - static_cast<long double>(b) * b);
    const Outcome<SurfacePoint> hit = sphere->firstHit({{-1000, b, 0}, {1, 0, 0}});
    ASSERT_TRUE(hit);
    // The parameter is about 1000 with an ulp of 1.1e-13; x follows it.
    EXPECT_NEAR(hit->position.x(), static_cast<double>(x), 3e-13) << static_cast<double>(gap);
  }
}

TEST(Analytic, Scale) {
  for (const double s : {1e-6, 1e-3, 1e3, 1e6}) {
    const auto one = makeAnalytic(test::torus(0.5, 0.2)), scaled = makeAnalytic(test::torus(0.5 * s, 0.2 * s));
    const Ray ray{{1, 0.2, 0.7}, Vector3d(-1, 0.1, -0.8).normalized()};
    const Outcome<SurfacePoint> a = one->firstHit(ray), b = scaled->firstHit({s * ray.origin, ray.direction});
    ASSERT_TRUE(a && b);
    EXPECT_NEAR((a->position - b->position / s).norm(), 0, 1e-14);
    EXPECT_NEAR(scaled->curvatureAt(*b)->k1 * s, one->curvatureAt(*a)->k1, 1e-11);
  }
}

TEST(Analytic, TessellationLiesOnTheSurfaceInsideItsBounds) {
  for (Row row : rows()) {
    row.spec.worldFromSurface = test::pose(0.5, {0.1, 0.2, 0.3});
    const auto surface = makeAnalytic(row.spec);
    const Eigen::AlignedBox3d region(Vector3d(-1, -1, -1), Vector3d(1, 1, 1));
    const TriangleMesh mesh = surface->tessellate(region, 24);
    ASSERT_GT(mesh.triangles.size(), 100u) << row.name;
    ASSERT_EQ(mesh.normals.size(), mesh.vertices.size());
    for (const Vector3d& v : mesh.vertices) {
      EXPECT_NEAR(row.implicit(row.spec.worldFromSurface.inverse() * v), 0, 1e-12) << row.name;
      EXPECT_TRUE((surface->bounds().min() - v).maxCoeff() < 1e-12 && (v - surface->bounds().max()).maxCoeff() < 1e-12)
          << row.name;
    }
    for (const Eigen::Vector3i& t : mesh.triangles) {
      const Vector3d n = (mesh.vertices[t[1]] - mesh.vertices[t[0]]).cross(mesh.vertices[t[2]] - mesh.vertices[t[0]]);
      EXPECT_GE(n.dot(mesh.normals[t[0]] + mesh.normals[t[1]] + mesh.normals[t[2]]), 0) << row.name;
    }
  }
}

// A quadric has no grid of its own: it is contoured. Oracles: Euler's formula, every edge between two triangles that go round it
// the opposite way, and the volume of an ellipsoid.
TEST(Analytic, AContouredEllipsoidIsClosed) {
  AnalyticSpec spec;
  spec.type = "quadric";
  spec.matrix.diagonal() << 1 / 0.36, 1 / 0.1225, 1 / 0.0625, -1;
  const TriangleMesh mesh =
      makeAnalytic(spec)->tessellate(Eigen::AlignedBox3d(Vector3d::Constant(-0.7), Vector3d::Constant(0.7)), 40);
  std::map<std::pair<int, int>, int> edges;
  double volume = 0;
  for (const Eigen::Vector3i& t : mesh.triangles) {
    for (int i = 0; i < 3; ++i) ++edges[{t[i], t[(i + 1) % 3]}];
    volume += mesh.vertices[t[0]].dot(mesh.vertices[t[1]].cross(mesh.vertices[t[2]])) / 6;
  }
  for (const auto& [edge, count] : edges) {
    EXPECT_EQ(count, 1);
    EXPECT_EQ(edges.count({edge.second, edge.first}), 1u);
  }
  EXPECT_EQ(int(mesh.vertices.size()) - int(edges.size() / 2) + int(mesh.triangles.size()), 2);
  const double whole = 4.0 / 3 * std::numbers::pi * 0.6 * 0.35 * 0.25;
  EXPECT_NEAR(volume, whole, 0.02 * whole);  // the vertices lie on it, the triangles inside: measured 1.5 %
  EXPECT_LT(volume, whole);
}

TEST(Analytic, DegenerateSpecificationsAreTheCallersBug) {
  AnalyticSpec zeroQuadric;
  zeroQuadric.type = "quadric";
  AnalyticSpec skewed = test::sphere(1);
  skewed.worldFromSurface.linear() *= 2;
  AnalyticSpec unknown;
  unknown.type = "klein bottle";
  for (const AnalyticSpec& spec : {test::sphere(0), test::sphere(-1), test::sphere(std::nan("")), test::sphere(INFINITY),
                                   test::ellipsoid(1, 0, 1), test::cylinder(0), test::torus(0.2, 0.5), test::sheet(std::nan("")),
                                   test::sheet(1, 0.0, 1.0), zeroQuadric, skewed, unknown})
    EXPECT_THROW(makeAnalytic(spec), std::invalid_argument) << spec.type;
  const auto sphere = makeAnalytic(test::sphere(1));
  EXPECT_EQ(sphere->firstHit({{0, 0, std::nan("")}, {0, 0, 1}}).failure().reason, Reason::NotFinite);
  EXPECT_EQ(sphere->firstHit({{0, 0, 3}, {0, 0, 1}}).failure().reason, Reason::NoHit);
}

TEST(Analytic, BoundsOfARotatedEllipsoidTouchIt) {
  AnalyticSpec spec = test::ellipsoid(0.6, 0.35, 0.25);
  spec.worldFromSurface = test::pose(0.7, {1, 2, 3});
  const Eigen::AlignedBox3d box = makeAnalytic(spec)->bounds();
  Eigen::AlignedBox3d sampled;
  for (const Vector3d& v : makeAnalytic(spec)->tessellate(Eigen::AlignedBox3d(), 200).vertices) sampled.extend(v);
  EXPECT_NEAR((box.min() - sampled.min()).norm(), 0, 1e-3);
  EXPECT_NEAR((box.max() - sampled.max()).norm(), 0, 1e-3);
}

}  // namespace
}  // namespace glint
