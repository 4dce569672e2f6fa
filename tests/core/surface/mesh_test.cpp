// SPDX-License-Identifier: BSD-3-Clause
#include "core/surface/mesh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/surface/brightest_point.h"
#include "core/surface/occlusion.h"
#include "tests/core/surface/surfaces.h"
#include "tests/tolerances.h"

namespace glint {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3i;

TriangleMesh tessellated(const AnalyticSpec& spec, int n) { return makeAnalytic(spec)->tessellate(Eigen::AlignedBox3d(), n); }

/// Nearest hit over all triangles, in double, without any tree. `margin`: smallest barycentric weight of that hit.
std::optional<double> bruteForce(const TriangleMesh& mesh, const Ray& ray, double& margin) {
  std::optional<double> best;
  for (const Vector3i& t : mesh.triangles) {
    Eigen::Matrix3d m;
    m << mesh.vertices[t.y()] - mesh.vertices[t.x()], mesh.vertices[t.z()] - mesh.vertices[t.x()], -ray.direction;
    const Vector3d s = m.fullPivLu().solve(ray.origin - mesh.vertices[t.x()]);
    const double low = std::min({s.x(), s.y(), 1 - s.x() - s.y()});
    if (low < 0 || !(s.z() > 0) || (best && *best <= s.z())) continue;
    best = s.z();
    margin = low;
  }
  return best;
}

/// Coordinates of a million metres leave 1e-10 m of a double: the mesh answers as it does at the origin.
TEST(Mesh, FarFromTheOriginNothingChanges) {
  const Vector3d far(1e6, -6e5, 3e5);
  const double slack = 2e-9;  // m; a few round-offs of the shifted vertices, origins and sums
  const TriangleMesh near = tessellated(test::torus(0.5, 0.2), 40);
  TriangleMesh shifted = near;
  for (Vector3d& v : shifted.vertices) v += far;
  for (const NormalPolicy policy : {NormalPolicy::Facet, NormalPolicy::Interpolated, NormalPolicy::Curved}) {
    const auto here = makeMesh(near, policy), there = makeMesh(shifted, policy);
    std::mt19937 rng(2);
    std::uniform_real_distribution<double> u(-1, 1);
    int hits = 0, hidden = 0;
    for (int i = 0; i < 300; ++i) {
      const Vector3d o = 2 * Vector3d(u(rng), u(rng), u(rng)).normalized(),
                     to = 2 * Vector3d(u(rng), u(rng), u(rng)).normalized();
      const Vector3d d = (0.5 * Vector3d(u(rng), u(rng), 0.2 * u(rng)) - o).normalized();
      const Outcome<SurfacePoint> a = here->firstHit({o, d}), b = there->firstHit({o + far, d});
      if (!a || !b || a->element != b->element) continue;  // at an outline or an edge round-off decides
      ++hits;
      EXPECT_LT((b->position - far - a->position).norm(),
                slack * (policy == NormalPolicy::Curved ? 10 : 1) / std::abs(a->normal.dot(d)));
      EXPECT_LT((b->normal - a->normal).norm(), 1e-6);  // across 1e-9 m of triangles of 3 cm
      hidden += here->occluded(*a, to) != there->occluded(*b, to + far);
    }
    EXPECT_GT(hits, 150);
    EXPECT_LE(hidden, 1);
  }
}

/// Embree asserts on coordinates beyond 1.8e18 and ended the program.
TEST(Mesh, RaysFromBeyondSinglePrecision) {
  const auto surface = makeMesh(tessellated(test::sphere(0.5), 20), NormalPolicy::Interpolated);
  const Vector3d away(0, 0, 1e20);
  EXPECT_FALSE(surface->firstHit({away, Vector3d(0, 0, 1)}));
  (void)surface->firstHit({away, Vector3d(0, 0, -1)});  // a hit or none: 1e20 leaves 1e4 m of a double
  (void)surface->firstHit({1e200 * away, Vector3d(0, 0, -1)});
  (void)surface->approximateHits({{away, Vector3d(0, 0, 1)}, {away, Vector3d(0, 0, -1)}, {1e30 * away, Vector3d(0, 1, 0)}});
  const Outcome<SurfacePoint> top = surface->firstHit({Vector3d(0, 0, 2), Vector3d(0, 0, -1)});
  ASSERT_TRUE(top);
  EXPECT_FALSE(surface->occluded(*top, away));
  EXPECT_TRUE(surface->occluded(*top, -away));
  const auto* many = dynamic_cast<const ManyOcclusions*>(surface.get());
  ASSERT_TRUE(many);
  EXPECT_EQ(many->occludedMany({*top, *top}, -away), (std::vector<char>{1, 1}));
  EXPECT_EQ(many->occludedMany({*top}, away), (std::vector<char>{0}));
}

TEST(Mesh, ManyOcclusionsAreThoseOfSinglePoints) {
  const auto surface = makeMesh(tessellated(test::torus(0.5, 0.2), 60), NormalPolicy::Interpolated);
  const auto& many = dynamic_cast<const ManyOcclusions&>(*surface);
  int hidden = 0, free = 0;
  for (const Vector3d& to : {Vector3d(0, 0, 3), Vector3d(1.5, 0.2, 0.3), Vector3d(0.1, 0.05, 0), Vector3d(400, -300, 20)}) {
    std::vector<SurfacePoint> points;
    std::vector<char> expected;
    for (int i = 0; i < 400; ++i) {  // where rays from all around meet the surface
      const double z = 1 - 2 * (i + 0.5) / 400, a = 2.399963 * i, r = std::sqrt(1 - z * z);
      const Vector3d from = 3 * Vector3d(r * std::cos(a), r * std::sin(a), z), target(0.5 * std::cos(a), 0.5 * std::sin(a), 0);
      const auto hit = surface->firstHit({from, (target - from).normalized()});
      if (!hit) continue;
      points.push_back(*hit);
      expected.push_back(surface->occluded(*hit, to));
      (expected.back() ? hidden : free) += 1;
      EXPECT_EQ(many.anyOccluded({*hit, *hit, *hit}, to), expected.back() != 0) << to.transpose() << ", " << i;
    }
    EXPECT_EQ(many.occludedMany(points, to), expected) << to.transpose();
    EXPECT_TRUE(many.anyOccluded(points, to));
  }
  EXPECT_GT(hidden, 200);
  EXPECT_GT(free, 200);
}

TEST(Mesh, HitsAgreeWithBruteForceInDouble) {
  const TriangleMesh mesh = tessellated(test::torus(0.5, 0.2), 40);
  const auto surface = makeMesh(mesh, NormalPolicy::Facet);
  std::mt19937 rng(1);
  std::uniform_real_distribution<double> u(-1, 1);
  int hits = 0, misses = 0;
  for (int i = 0; i < 400; ++i) {
    const Vector3d o = (i % 3 == 0 ? 20.0 : 1.2) * Vector3d(u(rng), u(rng), u(rng)).normalized();
    const Ray ray{o, (0.6 * Vector3d(u(rng), u(rng), 0.3 * u(rng)) - o).normalized()};
    double margin = 0;
    const std::optional<double> expected = bruteForce(mesh, ray, margin);
    const Outcome<SurfacePoint> hit = surface->firstHit(ray);
    if (!expected) {
      ++misses;
      EXPECT_FALSE(hit) << i;
      continue;
    }
    ++hits;
    if (margin < 1e-5) continue;  // so close to an outline's edge float may decide otherwise
    ASSERT_TRUE(hit) << i;
    EXPECT_NEAR((hit->position - ray.at(*expected)).norm(), 0, 1e-13 * (1 + o.norm())) << i;
  }
  EXPECT_GT(hits, 100);
  EXPECT_GT(misses, 30);
}

// surface.rays=single: the ray tracer's hits, off by no more than the single precision of coordinates of size 1 allows at this
// slant.
TEST(Mesh, SinglePrecisionIsNearAndIsNotDouble) {
  constexpr double kSinglePrecision = 2e-5;
  const TriangleMesh mesh = tessellated(test::torus(0.5, 0.2), 40);
  const auto exact = makeMesh(mesh, NormalPolicy::Interpolated);
  const auto single = makeMesh(mesh, MeshPolicy{NormalPolicy::Interpolated, RayPrecision::Single});
  std::mt19937 rng(2);
  std::uniform_real_distribution<double> u(-1, 1);
  int hits = 0;
  double worst = 0;
  for (int i = 0; i < 400; ++i) {
    const Vector3d o = 1.2 * Vector3d(u(rng), u(rng), u(rng)).normalized();
    const Ray ray{o, (0.6 * Vector3d(u(rng), u(rng), 0.3 * u(rng)) - o).normalized()};
    const Outcome<SurfacePoint> a = exact->firstHit(ray), b = single->firstHit(ray);
    if (!a || !b || std::abs(a->normal.dot(ray.direction)) < 0.1) continue;
    ++hits;
    EXPECT_LT((a->position - b->position).norm(), kSinglePrecision) << i;
    worst = std::max(worst, (a->position - b->position).norm());
  }
  EXPECT_GT(hits, 100);
  EXPECT_GT(worst, 1e-9);  // or the setting would do nothing
}

TEST(Mesh, ApproximateHitsAreNearTheExactOnes) {
  const auto surface = makeMesh(tessellated(test::sphere(0.4), 60), NormalPolicy::Interpolated);
  std::vector<Ray> rays;
  for (int i = 0; i < 101; ++i) rays.push_back({{0, -2, 0}, Vector3d(-0.3 + 0.006 * i, 1, 0.05).normalized()});
  const auto hits = surface->approximateHits(rays);
  ASSERT_EQ(hits.size(), rays.size());
  int both = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Outcome<SurfacePoint> exact = surface->firstHit(rays[i]);
    ASSERT_EQ(hits[i].has_value(), static_cast<bool>(exact)) << i;
    if (!exact) continue;
    ++both;
    EXPECT_NEAR((hits[i]->position - exact->position).norm(), 0, 1e-5);
  }
  EXPECT_GT(both, 50);
}

/// Largest error of position and normal over a fan of rays.
std::pair<double, double> worstErrors(const Surface& mesh, const Surface& truth) {
  double position = 0, normal = 0;
  for (int i = 0; i < 15; ++i)
    for (int j = 0; j < 15; ++j) {
      const Ray ray{{0.3, -2, 0.4}, (Vector3d(-0.3 + 0.043 * i, 0, -0.15 + 0.021 * j) - Vector3d(0.3, -2, 0.4)).normalized()};
      const Outcome<SurfacePoint> a = mesh.firstHit(ray), b = truth.firstHit(ray);
      EXPECT_TRUE(a && b);
      if (!a || !b) continue;
      position = std::max(position, (a->position - b->position).norm());
      normal = std::max(normal, a->normal.cross(b->normal).norm());
    }
  return {position, normal};
}

TEST(Mesh, TessellationsConvergeAsTheirPolicyPromises) {
  const AnalyticSpec spec = test::ellipsoid(0.6, 0.35, 0.25);
  const auto truth = makeAnalytic(spec);
  const auto order = [&](NormalPolicy policy) {
    const auto coarse = worstErrors(*makeMesh(tessellated(spec, 40), policy), *truth);
    const auto fine = worstErrors(*makeMesh(tessellated(spec, 160), policy), *truth);
    return std::pair{std::log(coarse.first / fine.first) / std::log(4.0), std::log(coarse.second / fine.second) / std::log(4.0)};
  };
  const auto facet = order(NormalPolicy::Facet), interpolated = order(NormalPolicy::Interpolated),
             curved = order(NormalPolicy::Curved);
  EXPECT_NEAR(facet.first, 2, 0.4);
  EXPECT_NEAR(facet.second, 1, 0.4);
  EXPECT_NEAR(interpolated.first, 2, 0.4);
  EXPECT_NEAR(interpolated.second, 2, 0.4);
  EXPECT_GT(curved.first, 2.6);  // third order in position: the quadratic patch
  EXPECT_GT(curved.second, 1.6);
}

TEST(Mesh, FootWalksAndQueriesToTheSamePoint) {
  for (const NormalPolicy policy : {NormalPolicy::Facet, NormalPolicy::Interpolated, NormalPolicy::Curved}) {
    const auto surface = makeMesh(tessellated(test::ellipsoid(0.6, 0.35, 0.25), 120), policy);
    const Outcome<SurfacePoint> start = surface->firstHit({{0.1, -2, 0.1}, {0, 1, 0}});
    ASSERT_TRUE(start);
    for (int k = 0; k < 36; ++k) {
      const double a = k * M_PI / 18;
      const Vector3d p = start->position + 0.08 * Vector3d(std::cos(a), 0, std::sin(a)) + Vector3d(0, -0.03, 0);
      SurfacePoint anywhere = *start;
      anywhere.element = -1;
      const Outcome<SurfacePoint> walked = surface->foot(p, {0, 1, 0}, *start), queried = surface->foot(p, {0, -1, 0}, anywhere);
      ASSERT_TRUE(walked && queried);
      EXPECT_NEAR((walked->position - queried->position).norm(), 0, 1e-13);
      EXPECT_NEAR(walked->position.x() - p.x(), 0, 1e-15);
      EXPECT_NEAR(walked->position.z() - p.z(), 0, 1e-15);
    }
    EXPECT_EQ(surface->foot({2, 0, 0}, {0, 1, 0}, *start).failure().reason, Reason::SurfaceEnded);
  }
}

TEST(Mesh, CurvatureComesFromTheNormalField) {
  for (const NormalPolicy policy : {NormalPolicy::Interpolated, NormalPolicy::Curved}) {
    const auto surface = makeMesh(tessellated(test::torus(0.5, 0.2), 400), policy);
    const Outcome<SurfacePoint> outer = surface->firstHit({{2, 0.01, 0.003}, {-1, 0, 0}});
    ASSERT_TRUE(outer);
    const Outcome<Curvature> c = surface->curvatureAt(*outer);
    ASSERT_TRUE(c);
    EXPECT_NEAR(c->k1, 5, 0.05);
    EXPECT_NEAR(c->k2, 1 / 0.7, 0.02);
    const Outcome<SurfacePoint> inner = surface->firstHit({{0, 0.002, 0.003}, {-1, 0, 0}});
    ASSERT_TRUE(inner);
    EXPECT_NEAR(surface->curvatureAt(*inner)->k2, -1 / 0.3, 0.05);
  }
  const auto facets = makeMesh(tessellated(test::sphere(1), 20), NormalPolicy::Facet);
  EXPECT_EQ(facets->curvatureAt(*facets->firstHit({{0, -3, 0}, {0, 1, 0}})).failure().reason, Reason::NotSupported);
}

TEST(Mesh, BrightestPointConvergesToTheAnalyticOne) {
  const AnalyticSpec spec = test::ellipsoid(0.6, 0.35, 0.25);
  const Camera camera = test::lookAt({0.4, -1.5, 1.4}, {0, 0, 0});
  const Light light = Light::at({0.9, -0.6, 2.0});
  const auto truth = predictedBrightestPoints(*makeAnalytic(spec), camera, light);
  ASSERT_TRUE(truth);
  for (const auto& [policy, tolerancePx] :
       {std::pair{NormalPolicy::Facet, 4.0}, {NormalPolicy::Interpolated, 0.05}, {NormalPolicy::Curved, 0.05}}) {
    const auto found = predictedBrightestPoints(*makeMesh(tessellated(spec, 300), policy), camera, light);
    ASSERT_TRUE(found) << found.failure().message() << " policy " << static_cast<int>(policy);
    EXPECT_EQ(found->size(), 1u) << static_cast<int>(policy);
    EXPECT_NEAR(((*found)[0].pixel - (*truth)[0].pixel).norm(), 0, tolerancePx) << static_cast<int>(policy);
    if (policy != NormalPolicy::Facet) {
      EXPECT_LT((*found)[0].alpha, 1e-12);
    }
  }
}

TEST(Mesh, NewtonCrossesTrianglesOfACoarseMesh) {
  const auto mesh = makeMesh(tessellated(test::sphere(0.4), 24), NormalPolicy::Interpolated);
  std::mt19937 rng(4);
  std::uniform_real_distribution<double> u(-1, 1);
  for (int i = 0; i < 60; ++i) {
    const Vector3d eye = 2 * Vector3d(u(rng), u(rng), u(rng)).normalized();
    Vector3d light = 3 * Vector3d(u(rng), u(rng), u(rng)).normalized();
    if (light.dot(eye) < 0.5) light = 3 * (light + eye).normalized();
    const auto found = predictedBrightestPoints(*mesh, test::lookAt(eye, {0, 0, 0}), Light::at(light));
    ASSERT_TRUE(found) << i << " " << found.failure().message();
    EXPECT_LT((*found)[0].alpha, 1e-10) << i;
  }
}

TEST(Mesh, Scale) {
  const TriangleMesh one = tessellated(test::ellipsoid(0.6, 0.35, 0.25), 60);
  const Ray ray{{0.2, -2, 0.5}, Vector3d(-0.05, 1, -0.22).normalized()};
  const Outcome<SurfacePoint> base = makeMesh(one, NormalPolicy::Curved)->firstHit(ray);
  ASSERT_TRUE(base);
  for (const double s : {1e-6, 1e-3, 1e3, 1e6}) {
    TriangleMesh scaled = one;
    const Eigen::Isometry3d m = test::pose(0.4, {10 * s, -3 * s, 2 * s});  // far from the origin for its size
    for (Vector3d& v : scaled.vertices) v = m * Vector3d(s * v);
    for (Vector3d& n : scaled.normals) n = m.linear() * n;
    const Outcome<SurfacePoint> hit =
        makeMesh(scaled, NormalPolicy::Curved)->firstHit({m * Vector3d(s * ray.origin), m.linear() * ray.direction});
    ASSERT_TRUE(hit) << s;
    EXPECT_NEAR((m.inverse() * hit->position / s - base->position).norm(), 0, 1e-12) << s;
  }
}

TEST(Mesh, ComputedNormalsApproachTheTrueOnes) {
  TriangleMesh mesh = tessellated(test::sphere(0.4), 200);
  mesh.normals.clear();
  const auto surface = makeMesh(mesh, NormalPolicy::Interpolated);
  const Outcome<SurfacePoint> hit = surface->firstHit({{0.05, -2, 0.07}, {0, 1, 0}});
  ASSERT_TRUE(hit);
  EXPECT_NEAR((hit->normal - hit->position.normalized()).norm(), 0, 1e-3);
}

struct Damage {
  const char* name;
  void (*apply)(TriangleMesh&);
};
class DamagedMesh : public testing::TestWithParam<Damage> {};

TEST_P(DamagedMesh, StillAnswersAsTheCleanOne) {
  for (const NormalPolicy policy : {NormalPolicy::Facet, NormalPolicy::Interpolated, NormalPolicy::Curved}) {
    TriangleMesh mesh = tessellated(test::sphere(0.4), 40);
    mesh.normals.clear();
    const auto clean = makeMesh(mesh, policy);
    GetParam().apply(mesh);
    const auto damaged = makeMesh(mesh, policy);
    for (int i = 0; i < 200; ++i) {
      const Ray ray{{0, -2, 0}, Vector3d(-0.15 + 0.0015 * i, 1, 0.1 * std::sin(i)).normalized()};
      const Outcome<SurfacePoint> a = clean->firstHit(ray), b = damaged->firstHit(ray);
      ASSERT_TRUE(a && b) << GetParam().name;
      EXPECT_NEAR((a->position - b->position).norm(), 0, 1e-9) << GetParam().name;
      EXPECT_NEAR(std::abs(a->normal.dot(b->normal)), 1, 1e-9) << GetParam().name;
      EXPECT_GT(a->normal.dot(b->normal), 0) << GetParam().name;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Mesh, DamagedMesh,
                         testing::Values(Damage{"repeated triangles",
                                                [](TriangleMesh& m) {
                                                  const std::size_t n = m.triangles.size();
                                                  for (std::size_t i = 0; i < n; i += 3) m.triangles.push_back(m.triangles[i]);
                                                }},
                                         Damage{"degenerate triangles",
                                                [](TriangleMesh& m) {
                                                  m.triangles.emplace_back(5, 5, 9);
                                                  m.triangles.emplace_back(7, 7, 7);
                                                  m.vertices.push_back(0.5 * (m.vertices[100] + m.vertices[101]));
                                                  m.triangles.emplace_back(100, 101, static_cast<int>(m.vertices.size()) - 1);
                                                }},
                                         Damage{"flipped triangles",
                                                [](TriangleMesh& m) {
                                                  for (std::size_t i = 0; i < m.triangles.size(); i += 5)
                                                    std::swap(m.triangles[i].x(), m.triangles[i].y());
                                                }},
                                         Damage{"unwelded corners", [](TriangleMesh& m) {
                                                  TriangleMesh soup;
                                                  for (const Vector3i& t : m.triangles) {
                                                    const int n = static_cast<int>(soup.vertices.size());
                                                    for (int k = 0; k < 3; ++k) soup.vertices.push_back(m.vertices[t[k]]);
                                                    soup.triangles.emplace_back(n, n + 1, n + 2);
                                                  }
                                                  m = soup;
                                                }}));

TEST(Mesh, NonManifoldEdgesAndBadInput) {
  // Three wings on one edge: every wing is hit, no walk crosses the edge by mistake.
  TriangleMesh wings;
  wings.vertices = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0.5}, {-1, 0, 0.5}, {0, 1, 0.5}};
  wings.triangles = {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}};
  for (const NormalPolicy policy : {NormalPolicy::Facet, NormalPolicy::Interpolated, NormalPolicy::Curved}) {
    const auto surface = makeMesh(wings, policy);
    EXPECT_TRUE(surface->firstHit({{0.2, -1, 0.5}, {0, 1, 0}}));
    EXPECT_TRUE(surface->firstHit({{-0.2, -1, 0.5}, {0, 1, 0}}));
    EXPECT_TRUE(surface->firstHit({{1, 0.2, 0.5}, {-1, 0, 0}}));
    EXPECT_EQ(surface->firstHit({{0.2, -1, 2}, {0, 1, 0}}).failure().reason, Reason::NoHit);
    EXPECT_EQ(surface->firstHit({{std::nan(""), -1, 2}, {0, 1, 0}}).failure().reason, Reason::NotFinite);
  }
  TriangleMesh bad = wings;
  bad.vertices[2].x() = std::nan("");
  try {
    makeMesh(bad, NormalPolicy::Facet);
    FAIL();
  } catch (const std::invalid_argument& e) {
    EXPECT_NE(std::string(e.what()).find("vertex 2"), std::string::npos);
  }
  bad = wings;
  bad.triangles[1].y() = 9;
  EXPECT_THROW(makeMesh(bad, NormalPolicy::Facet), std::invalid_argument);
  bad = wings;
  bad.triangles = {{0, 0, 1}};
  EXPECT_THROW(makeMesh(bad, NormalPolicy::Facet), std::invalid_argument);
  EXPECT_THROW(makeMesh({}, NormalPolicy::Facet), std::invalid_argument);
}

TEST(Mesh, OcclusionIgnoresItsOwnNeighbourhood) {
  for (const NormalPolicy policy : {NormalPolicy::Facet, NormalPolicy::Interpolated, NormalPolicy::Curved}) {
    const auto torus = makeMesh(tessellated(test::torus(0.5, 0.2), 200), policy);
    const auto truth = makeAnalytic(test::torus(0.5, 0.2));
    std::mt19937 rng(9);
    std::uniform_real_distribution<double> u(-1, 1);
    int occluded = 0, open = 0;
    for (int i = 0; i < 300; ++i) {
      const Vector3d o = 1.5 * Vector3d(u(rng), u(rng), u(rng)).normalized(), to = 2 * Vector3d(u(rng), u(rng), u(rng));
      const Ray ray{o, (Vector3d(0.5 * u(rng), 0.5 * u(rng), 0) - o).normalized()};
      const Outcome<SurfacePoint> p = torus->firstHit(ray), q = truth->firstHit(ray);
      if (!p || !q || std::abs(q->normal.dot((to - q->position).normalized())) < 0.1) continue;
      EXPECT_FALSE(torus->occluded(*p, o)) << i;
      const bool expected = truth->occluded(*q, to);
      // Segments that only graze another part may differ between the mesh and the smooth torus: those are rare.
      (expected ? occluded : open) += torus->occluded(*p, to) == expected;
    }
    EXPECT_GT(occluded, 30);
    EXPECT_GT(open, 30);
  }
}

}  // namespace
}  // namespace glint
