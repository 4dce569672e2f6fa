// SPDX-License-Identifier: BSD-3-Clause
// A surface that was moved, against the same surface whose own numbers say where it is: an analytic one by world_from_surface,
// a mesh by its vertices.
#include "core/surface/posed_surface.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "core/surface/mesh.h"
#include "core/surface/mirror_places.h"
#include "core/surface/occlusion.h"
#include "core/surface/part_bounds.h"
#include "tests/core/surface/surfaces.h"

namespace glint::posed_surface_tests {
namespace {
using Eigen::Isometry3d;
using Eigen::Vector3d;

struct Pair {
  std::shared_ptr<const Surface> moved, own;  // carried by movedTo(), and made in its place
};

Pair analyticPair(AnalyticSpec spec, const Isometry3d& at) {
  Pair pair{movedTo(at, makeAnalytic(spec)), nullptr};
  spec.worldFromSurface = at;
  pair.own = makeAnalytic(spec);
  return pair;
}

Pair meshPair(const Isometry3d& at) {
  TriangleMesh mesh = makeAnalytic(test::ellipsoid(0.3, 0.2, 0.25))->tessellate({}, 40);
  Pair pair{movedTo(at, makeMesh(mesh, MeshPolicy{})), nullptr};
  for (Vector3d& v : mesh.vertices) v = at * v;
  for (Vector3d& n : mesh.normals) n = at.linear() * n;
  pair.own = makeMesh(std::move(mesh), MeshPolicy{});
  return pair;
}

/// Rays at and beside the surface, feet, curvatures and shadows of both, at a tolerance of lengths.
void expectEqual(const Pair& p, const Isometry3d& at, double tolerance) {
  std::mt19937_64 rng(7);
  std::normal_distribution<double> gauss(0, 1);
  int hits = 0;
  for (int i = 0; i < 300; ++i) {
    const Vector3d eye = at * (1.5 * Vector3d(gauss(rng), gauss(rng), gauss(rng)).normalized());
    const Vector3d target = at * (0.2 * Vector3d(gauss(rng), gauss(rng), gauss(rng)));
    const Ray ray{eye, (target - eye).normalized()};
    const Outcome<SurfacePoint> a = p.moved->firstHit(ray), b = p.own->firstHit(ray);
    ASSERT_EQ(bool(a), bool(b)) << i;
    if (!a) continue;
    ++hits;
    EXPECT_LT((a->position - b->position).norm(), tolerance);
    EXPECT_LT((a->normal - b->normal).norm(), 1e-6);
    const Outcome<SurfacePoint> c = p.moved->foot(a->position + 0.01 * a->normal, a->normal, *a),
                                d = p.own->foot(b->position + 0.01 * b->normal, b->normal, *b);
    ASSERT_EQ(bool(c), bool(d));
    if (c) EXPECT_LT((c->position - d->position).norm(), tolerance);
    const Outcome<Curvature> k = p.moved->curvatureAt(*a), l = p.own->curvatureAt(*b);
    ASSERT_EQ(bool(k), bool(l));
    if (k) {
      EXPECT_NEAR(k->k1, l->k1, 1e-6 * std::abs(l->k1) + 1e-9);
      EXPECT_NEAR(std::abs(k->direction1.dot(a->normal)), 0, 1e-6);
    }
    const Vector3d lamp = at * Vector3d(0.2, -1.1, 1.3);
    EXPECT_EQ(p.moved->occluded(*a, lamp), p.own->occluded(*b, lamp));
  }
  EXPECT_GT(hits, 100);
}

TEST(MovedTo, AnAnalyticSurfaceAnswersAsOneThatSaysWhereItIs) {
  const Isometry3d at = test::pose(0.7, {0.4, -0.2, 1.1});
  for (const AnalyticSpec& spec : {test::ellipsoid(0.3, 0.2, 0.25), test::torus(0.3, 0.1), test::cylinder(0.2)})
    expectEqual(analyticPair(spec, at), at, 1e-9);
}

TEST(MovedTo, AMeshAnswersAsOneWhoseVerticesMoved) {
  const Isometry3d at = test::pose(-1.9, {-0.3, 0.8, 0.2});
  expectEqual(meshPair(at), at, 1e-6);
}

TEST(MovedTo, FarFromTheOriginTheObjectLosesNoDigits) {
  // The mesh stays where single precision is fine; one whose vertices moved a kilometre away would not.
  const Isometry3d at = test::pose(0.3, {1000, -2000, 500});
  const Pair p = meshPair(at);
  const Vector3d eye = at * Vector3d(0.1, 0.2, 1.5);
  const Ray ray{eye, (at * Vector3d(0.02, 0.01, 0) - eye).normalized()};
  const auto near = movedTo(Isometry3d::Identity(), p.moved);
  const Outcome<SurfacePoint> there = p.moved->firstHit(ray),
                              here = near->firstHit({at.inverse() * ray.origin, at.linear().transpose() * ray.direction});
  ASSERT_TRUE(there && here);
  EXPECT_LT((at.inverse() * there->position - here->position).norm(), 1e-9);
}

TEST(MovedTo, AMeshBoundsItsPartsWhereItIs) {
  const Isometry3d at = test::pose(2.2, {0.1, 0.3, -0.6});
  const Pair p = meshPair(at);
  const Camera camera = test::lookAt(at * Vector3d(1.2, 0.4, 0.9), at.translation());
  MirrorQuery query;
  query.eye = camera.centreInWorld();
  query.light << (at * Vector3d(0.6, -1, 1.4)), 1;
  query.sides = sidesOf(camera, Pixel(0, 0), Pixel(camera.width - 1, camera.height - 1));
  const auto a = dynamic_cast<const MirrorPlaces&>(*p.moved).mirrorPlaces(query),
             b = dynamic_cast<const MirrorPlaces&>(*p.own).mirrorPlaces(query);
  ASSERT_TRUE(a && b);
  ASSERT_FALSE(a->empty());
  double least = std::numeric_limits<double>::infinity();  // the trees differ, the place of the mirror does not
  for (const SurfacePoint& x : *a)
    for (const SurfacePoint& y : *b) least = std::min(least, (x.position - y.position).norm());
  EXPECT_LT(least, 0.05);
  std::vector<SurfacePoint> points;
  for (const SurfacePoint& x : *a) points.push_back(x);
  const std::vector<char> hidden = occludedMany(*p.moved, points, query.light.head<3>());
  for (std::size_t i = 0; i < points.size(); ++i) EXPECT_EQ(hidden[i] != 0, p.moved->occluded(points[i], query.light.head<3>()));
}

TEST(MovedTo, KnowsTheObjectAndItsPlace) {
  const auto object = makeAnalytic(test::sphere(0.2));
  const Isometry3d first = test::pose(0.4, {1, 2, 3}), second = test::pose(-0.8, {0, 1, 0});
  EXPECT_EQ(movedTo(Isometry3d::Identity(), object), object);
  const auto moved = movedTo(first, object), again = movedTo(second, moved);
  EXPECT_EQ(&objectOf(*again), object.get());
  EXPECT_TRUE(poseOf(*again).isApprox(second));
  EXPECT_TRUE(poseOf(*object).isApprox(Isometry3d::Identity()));
  EXPECT_EQ(movedTo(Isometry3d::Identity(), again), object);
  // The box holds the sphere where it is now.
  EXPECT_TRUE(again->bounds().contains(second.translation() + Vector3d(0.19, 0, 0)));
  const auto plane = movedTo(first, makeAnalytic(test::plane()));
  EXPECT_FALSE(plane->bounds().min().allFinite());
  Isometry3d broken = first;
  broken.translation().x() = std::nan("");
  EXPECT_THROW(movedTo(broken, object), std::invalid_argument);
}

TEST(MovedTo, TessellationIsWhereItIs) {
  const Isometry3d at = test::pose(1.1, {0.5, 0.5, 0.5});
  const TriangleMesh mesh = movedTo(at, makeAnalytic(test::sphere(0.2)))->tessellate({}, 20);
  ASSERT_FALSE(mesh.vertices.empty());
  for (const Vector3d& v : mesh.vertices) EXPECT_NEAR((v - at.translation()).norm(), 0.2, 1e-9);
}

}  // namespace
}  // namespace glint::posed_surface_tests
