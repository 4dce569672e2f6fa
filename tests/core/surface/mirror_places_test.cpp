// SPDX-License-Identifier: BSD-3-Clause
// The search of brightest points on meshes by ruling parts out: what it must not miss, and what it leaves to the grid.
#include "core/surface/mirror_places.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <tuple>

#include "core/surface/brightest_point.h"
#include "core/surface/mesh.h"
#include "tests/core/surface/surfaces.h"

namespace glint {
namespace {

using Eigen::Vector3d;

/// The same surface for the grid of rays only.
class OnlyRays final : public Surface {
 public:
  explicit OnlyRays(const Surface& surface) : surface_(surface) {}
  std::string describe() const override { return surface_.describe(); }
  Outcome<SurfacePoint> firstHit(const Ray& ray) const override { return surface_.firstHit(ray); }
  std::vector<std::optional<SurfacePoint>> approximateHits(const std::vector<Ray>& rays) const override {
    return surface_.approximateHits(rays);
  }
  Outcome<SurfacePoint> foot(const Vector3d& p, const Vector3d& d, const SurfacePoint& previous) const override {
    return surface_.foot(p, d, previous);
  }
  Outcome<Curvature> curvatureAt(const SurfacePoint& p) const override { return surface_.curvatureAt(p); }
  bool occluded(const SurfacePoint& from, const Vector3d& to) const override { return surface_.occluded(from, to); }
  Eigen::AlignedBox3d bounds() const override { return surface_.bounds(); }
  TriangleMesh tessellate(const Eigen::AlignedBox3d& region, int n) const override { return surface_.tessellate(region, n); }

 private:
  const Surface& surface_;
};

TriangleMesh torus(int n) { return makeAnalytic(test::torus(0.5, 0.2))->tessellate(Eigen::AlignedBox3d(), n); }
/// An open sheet with bumps: many places where normals are parallel.
TriangleMesh waves(int n) {
  TriangleMesh mesh = makeAnalytic(test::sheet(0, 1.0, 1.0))->tessellate(Eigen::AlignedBox3d(), n);
  mesh.normals.clear();
  for (Vector3d& v : mesh.vertices) v.z() = 0.02 * std::sin(9 * v.x()) * std::cos(8 * v.y());
  return mesh;
}
void turnSome(TriangleMesh& mesh) {
  mesh.normals.clear();
  for (std::size_t i = 0; i < mesh.triangles.size(); i += 5) std::swap(mesh.triangles[i].x(), mesh.triangles[i].y());
}
void repeatSome(TriangleMesh& mesh) {
  const std::size_t n = mesh.triangles.size();
  for (std::size_t i = 0; i < n; i += 3) mesh.triangles.push_back(mesh.triangles[i]);
  mesh.triangles.emplace_back(7, 7, 7);
}

struct Counts {
  int made = 0, missed = 0, missedByRays = 0;
};

/// Lights are placed where the reflection law holds at a random visible point: at a random distance, sometimes at infinity. How
/// often that point is not among those found.
Counts countMissed(const TriangleMesh& mesh, NormalPolicy policy, int trials, double reach) {
  const auto surface = makeMesh(mesh, policy);
  const OnlyRays onlyRays(*surface);
  std::mt19937 rng(17);
  std::uniform_real_distribution<double> u(-1, 1);
  Counts counts;
  for (int i = 0; i < trials; ++i) {
    const Vector3d eye = reach * (Vector3d(u(rng), u(rng), 0.3 + std::abs(u(rng)))).normalized();
    const Camera camera = test::lookAt(eye, 0.2 * Vector3d(u(rng), u(rng), u(rng)), 500);
    const auto hit = surface->firstHit(camera.ray({320 + 250 * u(rng), 240 + 180 * u(rng)}));
    if (!hit) continue;
    const SurfacePoint p = facing(*hit, eye);
    const Vector3d v = (eye - p.position).normalized(), toLight = reflect(v, p.normal);
    if (!(p.normal.dot(v) > 0.1)) continue;
    const double distance = reach * std::exp(3 * u(rng));
    const Light light = i % 4 == 0 ? Light::towards(toLight) : Light::at(p.position + distance * toLight);
    if (surface->occluded(p, p.position + (i % 4 == 0 ? 100 : distance) * toLight)) continue;
    ++counts.made;
    const auto near = [&](const Outcome<std::vector<BrightestPoint>>& found) {
      if (!found) return false;
      return std::any_of(found->begin(), found->end(),
                         [&](const BrightestPoint& b) { return (b.point.position - p.position).norm() < 1e-6 * reach; });
    };
    if (!near(predictedBrightestPoints(*surface, camera, light))) ++counts.missed;
    if (!near(predictedBrightestPoints(onlyRays, camera, light))) ++counts.missedByRays;
  }
  return counts;
}

/// The tree of one triangle (or of a few in one cell) is a root with one part; it was no tree at all and was read beyond its end.
TEST(MirrorPlaces, OneTriangle) {
  TriangleMesh mesh;
  mesh.vertices = {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}};
  const auto surface = makeMesh(mesh, NormalPolicy::Interpolated);
  const auto* places = dynamic_cast<const MirrorPlaces*>(surface.get());
  ASSERT_TRUE(places);
  MirrorQuery query;
  query.eye = Vector3d(0.2, 0, 2);
  query.light << -0.2, 0, 2, 1;  // the mirror point of a plane is half-way: (0, 0, 0)
  query.sides.fill(Vector3d(0, 0, -1));
  const std::optional<std::vector<SurfacePoint>> found = places->mirrorPlaces(query);
  ASSERT_TRUE(found);
  ASSERT_EQ(found->size(), 1u);
  EXPECT_EQ(found->front().element, 0);
  query.light << -5, 0, 2, 1;  // half-way in angle lies outside of the triangle, and no N is parallel to H on it
  EXPECT_TRUE(places->mirrorPlaces(query));
}

// Truth by construction. What is left are lights near a caustic (the torus' upper circle), where solutions merge: the grid of
// rays misses those too, and more.
TEST(MirrorPlaces, ConstructedMirrorPointsAreFound) {
  int missed = 0, missedByRays = 0;
  for (const NormalPolicy policy : {NormalPolicy::Interpolated, NormalPolicy::Curved}) {
    TriangleMesh damaged = torus(100);
    turnSome(damaged);
    repeatSome(damaged);
    for (const TriangleMesh& mesh : {waves(12), waves(100), torus(100), damaged, torus(200)}) {
      const Counts c = countMissed(mesh, policy, 200, 2.0);
      EXPECT_GT(c.made, 40);
      EXPECT_LE(c.missed, 0.03 * c.made) << mesh.triangles.size() << " triangles";
      missed += c.missed;
      missedByRays += c.missedByRays;
    }
  }
  EXPECT_LT(2 * missed, missedByRays);
}

TEST(MirrorPlaces, AnswersAreThoseOfADenseGrid) {
  const auto surface = makeMesh(torus(300), NormalPolicy::Interpolated);
  const OnlyRays onlyRays(*surface);
  BrightestPointOptions dense;
  dense.seedStepPx = 3;
  std::mt19937 rng(5);
  std::uniform_real_distribution<double> u(-1, 1);
  int several = 0;
  for (int i = 0; i < 10; ++i) {
    const Vector3d eye(1.5 * u(rng), 1.5 * u(rng), 1.2 + 0.5 * u(rng)), light(2 * u(rng), 2 * u(rng), 2 + u(rng));
    const Camera camera = test::lookAt(eye, {0, 0, 0}, 500);
    const auto found = predictedBrightestPoints(*surface, camera, Light::at(light));
    const auto all = predictedBrightestPoints(onlyRays, camera, Light::at(light), dense);
    ASSERT_EQ(static_cast<bool>(found), static_cast<bool>(all)) << i;
    if (!found) continue;
    ASSERT_EQ(found->size(), all->size()) << i;
    several += found->size() > 1;
    for (std::size_t k = 0; k < found->size(); ++k)
      // Both end at the round-off of |N x H|; 1e-9 px is a hundred times that of the pixel.
      EXPECT_NEAR(((*found)[k].pixel - (*all)[k].pixel).norm(), 0, 1e-9) << i;
  }
  EXPECT_GT(several, 2);
}

MirrorQuery query(const Vector3d& eye, const Light& light) {
  // Planes that leave everything inside.
  const Vector3d anywhere = -eye.normalized();
  return {eye, light.homogeneous(), {anywhere, anywhere, anywhere, anywhere}};
}

TEST(MirrorPlaces, FewPartsOfASmoothSurfaceRemain) {
  const auto surface = makeMesh(makeAnalytic(test::ellipsoid(0.6, 0.35, 0.25))->tessellate(Eigen::AlignedBox3d(), 300),
                                NormalPolicy::Interpolated);
  const auto& places = dynamic_cast<const MirrorPlaces&>(*surface);
  for (const double distance : {1.0, 3.0, 1e4, 1e9})  // float must not rule out the truth, nor give up, with far eyes and lights
    for (const double lightDistance : {2.0, 1e6, 1e12}) {
      const Vector3d eye = distance * Vector3d(0.2, -1, 0.7), light = lightDistance * Vector3d(0.5, -0.4, 0.9);
      const auto left = places.mirrorPlaces(query(eye, Light::at(light)));
      ASSERT_TRUE(left);
      EXPECT_GE(left->size(), 2u);  // the mirror points of both sides
      EXPECT_LE(left->size(), 40u);
      double best = 2;  // angle between N and H on the outer side; parts are 0.01 rad wide
      for (const SurfacePoint& p : *left)
        best = std::min(best, incidentAngle(p.normal, (light - p.position).normalized(), (eye - p.position).normalized()));
      EXPECT_LT(best, 0.02) << distance << " " << lightDistance;
    }
}

TEST(MirrorPlaces, LeavesRoughSurfacesAndFacetsToTheGrid) {
  TriangleMesh rough = torus(100);
  std::mt19937 rng(3);
  std::normal_distribution<double> gauss(0, 0.5);
  for (Vector3d& n : rough.normals) n = (n + Vector3d(gauss(rng), gauss(rng), gauss(rng))).normalized();
  const MirrorQuery q = query({0, -1, 2}, Light::at({1, 0, 3}));
  EXPECT_FALSE(dynamic_cast<const MirrorPlaces&>(*makeMesh(rough, NormalPolicy::Interpolated)).mirrorPlaces(q));
  EXPECT_FALSE(dynamic_cast<const MirrorPlaces&>(*makeMesh(torus(20), NormalPolicy::Facet)).mirrorPlaces(q));
  EXPECT_FALSE(dynamic_cast<const MirrorPlaces&>(*makeMesh(torus(20), NormalPolicy::Interpolated, false)).mirrorPlaces(q));
  EXPECT_TRUE(dynamic_cast<const MirrorPlaces&>(*makeMesh(torus(20), NormalPolicy::Interpolated)).mirrorPlaces(q));
}

TEST(MirrorPlaces, OnlyThoseInsideTheView) {
  // The mirror point lies at the right of the picture: a view that ends to its left has no place, one that contains it has.
  const auto surface =
      makeMesh(makeAnalytic(test::sphere(0.4))->tessellate(Eigen::AlignedBox3d(), 100), NormalPolicy::Interpolated);
  const auto& places = dynamic_cast<const MirrorPlaces&>(*surface);
  const Vector3d eye(0, -3, 0);
  const Light light = Light::at({4, -1, 0});
  MirrorQuery q = query(eye, light);
  q.sides[0] = {-1, 0, 0};  // x < 0
  const auto left = places.mirrorPlaces(q);
  ASSERT_TRUE(left);
  for (const SurfacePoint& p : *left) EXPECT_LT(p.position.x(), 0.03);
  q.sides[0] = {1, 0, 0};
  const auto right = places.mirrorPlaces(q);
  ASSERT_TRUE(right);
  int near = 0;
  for (const SurfacePoint& p : *right) {
    const double alpha = incidentAngle(p.normal, light.directionFrom(p.position), (eye - p.position).normalized());
    near += alpha < 0.1;
  }
  EXPECT_GT(near, 0);
}

/// Which directions of the ball's faces are outward: a tetrahedron whose vertex normals are radial has acos(1/3) between them and
/// the planes of its faces.
TriangleMesh tetrahedron() {
  TriangleMesh mesh;
  for (const Vector3d& v : {Vector3d(1, 1, 1), Vector3d(1, -1, -1), Vector3d(-1, 1, -1), Vector3d(-1, -1, 1)}) {
    mesh.vertices.push_back(v + Vector3d(5, 0, 2));
    mesh.normals.push_back(v.normalized());
  }
  mesh.triangles = {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}};
  return mesh;
}

TEST(OutwardDeviation, OfATetrahedron) {
  const auto of = [](const TriangleMesh& mesh) { return outwardDeviation(mesh, topologyOf(mesh), mesh.normals); };
  TriangleMesh mesh = tetrahedron();
  EXPECT_NEAR(of(mesh).value(), std::acos(1.0 / 3), 1e-12);
  std::swap(mesh.triangles[2].x(), mesh.triangles[2].y());  // windings do not count
  EXPECT_NEAR(of(mesh).value(), std::acos(1.0 / 3), 1e-12);
  for (Vector3d& n : mesh.normals) n = -n;
  EXPECT_NEAR(of(mesh).value(), std::acos(-1.0 / 3), 1e-12);
}

TEST(OutwardDeviation, NotWithABorder) {
  const auto of = [](const TriangleMesh& mesh) { return outwardDeviation(mesh, topologyOf(mesh), mesh.normals); };
  TriangleMesh open = tetrahedron();
  open.triangles.pop_back();
  EXPECT_FALSE(of(open));
  TriangleMesh sheet = waves(12);
  sheet.normals = vertexNormals(sheet, topologyOf(sheet));
  EXPECT_FALSE(of(sheet));
  // A closed part beside an open one.
  TriangleMesh both = tetrahedron();
  const int first = static_cast<int>(both.vertices.size());
  for (int k = 0; k < 3; ++k) both.vertices.push_back(Vector3d::Unit(k)), both.normals.push_back(Vector3d::Ones().normalized());
  both.triangles.emplace_back(first, first + 1, first + 2);
  EXPECT_FALSE(of(both));
}

// Parts that the eye sees are never left out; of a closed surface most of the far side is.
TEST(BoundedParts, HoldAllThatIsSeen) {
  const PartTest all = [](const PartBounds&) { return Eight(Eight::Ones()); };
  constexpr std::size_t kMany = 1 << 20;
  TriangleMesh openTorus = torus(60);
  openTorus.triangles.pop_back();
  TriangleMesh coarse = torus(8), inward = torus(60), inner = torus(60), tilted = torus(60);
  for (Vector3d& n : inward.normals) n = -n;
  for (Vector3d& n : tilted.normals) n = (n + 0.5 * Vector3d::UnitZ()).normalized();  // seen from below, many point away
  for (const auto& [mesh, eye, left] : {std::tuple{torus(60), Vector3d(1.1, -1.6, 1.2), 0.65},
                                        {coarse, Vector3d(1.1, -1.6, 1.2), 1.0},
                                        {openTorus, Vector3d(1.1, -1.6, 1.2), 1.0},
                                        {inward, Vector3d(1.1, -1.6, 1.2), 1.0},
                                        {inner, Vector3d(0.5, 0, 0.05), 1.0},
                                        {tilted, Vector3d(1.1, -1.6, -1.2), 1.0},
                                        {torus(60), Vector3d(100, 50, -30), 0.65}}) {
    const auto surface = makeMesh(mesh, NormalPolicy::Interpolated);
    const auto& bounded = dynamic_cast<const BoundedParts&>(*surface);
    MirrorQuery everywhere = query(eye, Light::at({1, 0, 3}));
    everywhere.sides.fill(Vector3d::Zero());  // rules nothing out
    const auto parts = bounded.partsThatMay(everywhere, 0, all, kMany);
    ASSERT_TRUE(parts);
    EXPECT_LE(parts->size(), left * mesh.triangles.size());
    EXPECT_GT(parts->size(), 0.3 * mesh.triangles.size());
    std::vector<char> known(mesh.triangles.size(), 0);  // every part is one triangle
    for (const SurfacePart& p : *parts) known[p.middle.element] = 1;
    int seen = 0;
    for (int i = 0; i < 20000; ++i) {  // rays in all directions, on a spiral
      const double z = 1 - 2 * (i + 0.5) / 20000, a = 2.399963 * i, r = std::sqrt(1 - z * z);
      const Vector3d target = 0.75 * Vector3d(r * std::cos(a), r * std::sin(a), z);
      const auto hit = surface->firstHit({eye, (target - eye).normalized()});
      if (!hit) continue;
      ++seen;
      EXPECT_TRUE(known[hit->element]) << eye.transpose();
    }
    EXPECT_GT(seen, 1000);
  }
}

}  // namespace
}  // namespace glint
