// SPDX-License-Identifier: BSD-3-Clause
#include "core/surface/point_surface.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <random>

#include "core/surface/mesh.h"

namespace glint::point_surface_tests {
namespace {
using Eigen::Vector3d;
using testing::HasSubstr;

constexpr double kRadius = 0.5;
constexpr int kPoints = 3000;
const double kSpacing = std::sqrt(4 * M_PI * kRadius * kRadius / kPoints);  // side of the square that each point has: 0.0324

/// Points on a sphere around `centre`, evenly at random, moved by noise along the radius.
PointCloud sphere(double noise, double scale = 1, const Vector3d& centre = Vector3d::Zero()) {
  std::mt19937_64 rng(20261);
  std::normal_distribution<double> gauss;
  PointCloud cloud;
  for (int i = 0; i < kPoints; ++i) {
    const Vector3d d = Vector3d(gauss(rng), gauss(rng), gauss(rng)).normalized();
    cloud.points.push_back(centre + scale * (kRadius + noise * gauss(rng)) * d);
  }
  return cloud;
}

struct Errors {
  int rays = 0, missed = 0;
  double normalDeg = 0, position = 0;  ///< root mean squares
};

/// Rays towards the centre from all sides, against the sphere itself.
Errors errorsOf(const TriangleMesh& mesh) {
  const std::shared_ptr<const Surface> surface = makeMesh(mesh, MeshPolicy{NormalPolicy::Interpolated});
  std::mt19937_64 rng(7);
  std::normal_distribution<double> gauss;
  Errors e;
  for (int i = 0; i < 2000; ++i) {
    const Vector3d d = Vector3d(gauss(rng), gauss(rng), gauss(rng)).normalized();
    ++e.rays;
    const Outcome<SurfacePoint> hit = surface->firstHit({3 * d, -d});
    if (!hit || std::abs(hit->position.norm() - kRadius) > kRadius / 4) {
      ++e.missed;
      continue;
    }
    const double degrees = std::acos(std::min(1.0, std::abs(hit->normal.dot(d)))) * 180 / M_PI;
    e.normalDeg += degrees * degrees;
    e.position += std::pow(hit->position.norm() - kRadius, 2);
  }
  const double n = std::max(1, e.rays - e.missed);
  e.normalDeg = std::sqrt(e.normalDeg / n);
  e.position = std::sqrt(e.position / n);
  return e;
}

TEST(SurfaceOfPoints, Nominal) {
  const Outcome<PointSurface> made = surfaceOfPoints(sphere(0));
  ASSERT_TRUE(made) << made.failure().message();
  EXPECT_EQ(made->facts.points, std::size_t(kPoints));
  EXPECT_NEAR(made->facts.spacing, kSpacing, 0.1 * kSpacing);
  const Errors e = errorsOf(made->mesh);
  EXPECT_EQ(e.missed, 0);
  EXPECT_LT(e.normalDeg, 0.2);                           // measured 0.1
  EXPECT_LT(e.position, kSpacing * kSpacing / kRadius);  // the height of a facet's arc is a fraction of this
  // Euler: a closed surface of V vertices has 2 V - 4 triangles.
  EXPECT_NEAR(double(made->mesh.triangles.size()), 2.0 * double(made->mesh.vertices.size()) - 4, 8);
}

TEST(SurfaceOfPoints, ScaleAndPlaceChangeNothing) {
  const Outcome<PointSurface> one = surfaceOfPoints(sphere(0.1 * kSpacing));
  ASSERT_TRUE(one);
  for (const double scale : {1e-3, 1e3}) {
    const Outcome<PointSurface> other = surfaceOfPoints(sphere(0.1 * kSpacing, scale, scale * Vector3d(20, -10, 5)));
    ASSERT_TRUE(other) << scale;
    EXPECT_EQ(other->facts.neighbours, one->facts.neighbours);
    EXPECT_NEAR(other->facts.normalSigmaDeg, one->facts.normalSigmaDeg, 1e-3);
    EXPECT_NEAR(other->facts.noise / scale, one->facts.noise, 1e-6 * kRadius);
    EXPECT_NEAR(double(other->mesh.triangles.size()), double(one->mesh.triangles.size()), 4);
  }
}

TEST(SurfaceOfPoints, NoiseIsSmoothedAndStated) {
  const double noise = 0.1 * kSpacing;
  const Outcome<PointSurface> made = surfaceOfPoints(sphere(noise));
  ASSERT_TRUE(made) << made.failure().message();
  EXPECT_NEAR(made->facts.noise, noise, 0.3 * noise);  // a left-out point is off by its own noise and that of its fit
  const Errors e = errorsOf(made->mesh);
  EXPECT_LT(e.missed, 10);
  EXPECT_LT(e.normalDeg, 1.0);  // facets through the points themselves are off by 6 degrees
  EXPECT_LT(e.position, noise);
  EXPECT_GT(made->facts.normalSigmaDeg, 0.4 * e.normalDeg);
  EXPECT_LT(made->facts.normalSigmaDeg, 2.5 * e.normalDeg);
}

TEST(SurfaceOfPoints, DegenerateCloudsAreRefusedByName) {
  PointCloud few;
  few.points.assign(kFewestPoints - 1, Vector3d::Zero());
  EXPECT_EQ(surfaceOfPoints(few).failure().reason, Reason::TooFewPoints);
  few.points.assign(1000, Vector3d(1, 2, 3));  // one point, many times
  EXPECT_EQ(surfaceOfPoints(few).failure().reason, Reason::TooFewPoints);
  PointCloud line;
  for (int i = 0; i < 500; ++i) line.points.emplace_back(0.01 * i, 0, 0);
  EXPECT_FALSE(surfaceOfPoints(line));
  PointCloud nan = sphere(0);
  nan.points[5].x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(surfaceOfPoints(nan).failure().reason, Reason::NotFinite);
  const Outcome<PointSurface> noisy = surfaceOfPoints(sphere(kSpacing));
  ASSERT_FALSE(noisy);
  EXPECT_EQ(noisy.failure().reason, Reason::NoSurface);
  EXPECT_THAT(noisy.failure().detail, HasSubstr("the normals are uncertain by"));
}

TEST(SurfaceOfPoints, HolesStayHolesAndPointsOffTheSurfaceAreLeftOut) {
  PointCloud plane;
  constexpr int kSide = 60;
  constexpr double kStep = 0.01;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      const Vector3d p(kStep * x, kStep * y, 0);
      if ((p - Vector3d(0.3, 0.3, 0)).norm() > 0.08) plane.points.push_back(p);  // eight steps: no circle of three
    }
  const std::size_t points = plane.points.size();
  for (int i = 0; i < 10; ++i) plane.points.emplace_back(0.05 + 0.05 * i, 0.1, 0.03);  // three steps above
  const Outcome<PointSurface> made = surfaceOfPoints(plane);
  ASSERT_TRUE(made) << made.failure().message();
  EXPECT_LE(made->facts.used, points);
  const std::shared_ptr<const Surface> surface = makeMesh(made->mesh, MeshPolicy{NormalPolicy::Interpolated});
  EXPECT_FALSE(surface->firstHit({Vector3d(0.3, 0.3, 1), -Vector3d::UnitZ()}));
  for (const double x : {0.051, 0.152, 0.45, 0.585}) {
    const Outcome<SurfacePoint> hit = surface->firstHit({Vector3d(x, 0.1034, 1), -Vector3d::UnitZ()});
    ASSERT_TRUE(hit) << x;
    EXPECT_NEAR(hit->position.z(), 0, 0.2 * kStep);
  }
}

TEST(SurfaceOfPoints, NormalsTellTheSidesOfAThinSheet) {
  PointCloud sheet;
  constexpr int kSide = 40;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x)
      for (const double side : {-1.0, 1.0}) {
        sheet.points.emplace_back(0.01 * (x + 0.25 * side), 0.01 * (y + 0.1 * side), 0.004 * side);
        sheet.normals.emplace_back(0, 0, side);
      }
  const Outcome<PointSurface> made = surfaceOfPoints(sheet);
  ASSERT_TRUE(made) << made.failure().message();
  const std::shared_ptr<const Surface> surface = makeMesh(made->mesh, MeshPolicy{NormalPolicy::Interpolated});
  for (const double side : {-1.0, 1.0}) {
    const Outcome<SurfacePoint> hit = surface->firstHit({Vector3d(0.2017, 0.2023, side), -side * Vector3d::UnitZ()});
    ASSERT_TRUE(hit);
    EXPECT_NEAR(hit->position.z(), 0.004 * side, 1e-6);
    EXPECT_NEAR(std::abs(hit->normal.z()), 1, 1e-6);
  }
}

}  // namespace
}  // namespace glint::point_surface_tests
