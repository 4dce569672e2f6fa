// SPDX-License-Identifier: BSD-3-Clause
#include "core/surface/registration.h"

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>

#include "core/surface/mesh.h"

namespace glint::registration_tests {
namespace {
using Eigen::Vector3d;
using testing::HasSubstr;

/// A closed body of `shape`(unit direction) -> radius, of 2 rings^2 triangles or so.
template <class Shape>
TriangleMesh body(const Shape& shape, int rings = 40) {
  TriangleMesh mesh;
  const int sectors = 2 * rings;
  for (int i = 0; i <= rings; ++i)
    for (int k = 0; k < sectors; ++k) {
      const double polar = M_PI * (i == 0 ? 0.001 : i == rings ? rings - 0.001 : i) / rings, around = 2 * M_PI * k / sectors;
      const Vector3d d(std::sin(polar) * std::cos(around), std::sin(polar) * std::sin(around), std::cos(polar));
      mesh.vertices.push_back(shape(d));
    }
  for (int i = 0; i < rings; ++i)
    for (int k = 0; k < sectors; ++k) {
      const int a = i * sectors + k, b = i * sectors + (k + 1) % sectors;
      mesh.triangles.emplace_back(a, a + sectors, b + sectors);
      mesh.triangles.emplace_back(a, b + sectors, b);
    }
  return mesh;
}

/// Nothing about it is symmetric: a lump with a nose, a flat side and a dent.
Vector3d lump(const Vector3d& d) {
  const auto bump = [&](const Vector3d& at, double height, double width) {
    return height * std::exp((d.dot(at.normalized()) - 1) / (width * width));
  };
  const double r = 1 + bump({1, 0.2, 0.3}, 0.5, 0.35) + bump({-0.3, 1, -0.5}, -0.25, 0.5) + bump({0.1, -0.8, 0.9}, 0.3, 0.4);
  return {0.7 * r * d.x() + 0.2, 0.5 * r * d.y() - 0.1, 0.4 * r * d.z() + 1.3};
}
Vector3d ball(const Vector3d& d) { return 0.5 * d + Vector3d(0.3, 0, 0.1); }
Vector3d ellipsoid(const Vector3d& d) { return {0.21 * d.x(), 0.155 * d.y(), 0.115 * d.z()}; }

Similarity anySimilarity(unsigned seed, double scale) {
  std::mt19937_64 rng(seed);
  std::normal_distribution<double> gauss;
  const Eigen::Quaterniond q = Eigen::Quaterniond(gauss(rng), gauss(rng), gauss(rng), gauss(rng)).normalized();
  return {scale, q.toRotationMatrix(), scale * Vector3d(3 * gauss(rng), 3 * gauss(rng), 3 * gauss(rng))};
}

struct Cloud {
  int onObject = 200;
  double noise = 0;       ///< along each axis, in mesh units
  double background = 0;  ///< share of all points
  double cameras = 300;   ///< degrees of a turn about the object that the cameras take
  unsigned seed = 1;
};

/// What a structure-from-motion program would leave: points of triangles that look at a camera, and of a floor and walls around.
std::vector<SeenPoint> cloudOf(const TriangleMesh& mesh, const Similarity& s, const Cloud& c) {
  std::mt19937_64 rng(c.seed);
  std::normal_distribution<double> gauss;
  std::uniform_real_distribution<double> uniform;
  Eigen::AlignedBox3d box;
  for (const Vector3d& v : mesh.vertices) box.extend(v);
  const Vector3d middle = box.center();
  const double size = box.sizes().norm();
  std::vector<Vector3d> eyes;
  for (int i = 0; i < 24; ++i) {
    const double a = c.cameras * M_PI / 180 * i / 24;
    eyes.push_back(middle + 2.5 * size * Vector3d(std::cos(a), std::sin(a), 0.4));
  }
  const std::shared_ptr<const Surface> surface = makeMesh(mesh, MeshPolicy{NormalPolicy::Facet}, false);
  std::vector<SeenPoint> points;
  const auto noisy = [&](const Vector3d& p) { return Vector3d(p + c.noise * Vector3d(gauss(rng), gauss(rng), gauss(rng))); };
  while (static_cast<int>(points.size()) < c.onObject) {
    const Eigen::Vector3i t = mesh.triangles[std::size_t(uniform(rng) * double(mesh.triangles.size()))];
    const Vector3d a = mesh.vertices[std::size_t(t[0])], b = mesh.vertices[std::size_t(t[1])],
                   d = mesh.vertices[std::size_t(t[2])];
    const Vector3d eye = eyes[std::size_t(uniform(rng) * 24)], outwards = (b - a).cross(d - a).normalized();
    const double u = uniform(rng), v = uniform(rng) * (1 - u);
    const Vector3d p = a + u * (b - a) + v * (d - a);
    const Vector3d towards = (eye - p).normalized();
    if (outwards.dot(towards) < 0.2 || surface->firstHit({p + 1e-6 * size * towards, towards})) continue;  // it is not seen
    points.push_back({s * noisy(p), s * eye});
  }
  const int behind = static_cast<int>(c.background / (1 - c.background) * c.onObject);
  for (int i = 0; i < behind; ++i) {
    const Vector3d eye = eyes[std::size_t(uniform(rng) * 24)];
    Vector3d p = middle + size * Vector3d(4 * uniform(rng) - 2, 4 * uniform(rng) - 2, -0.55);         // a floor
    if (i % 3 == 1) p = middle + size * Vector3d(2 * (2 * uniform(rng) - 1), 2.2, 2 * uniform(rng));  // a wall
    if (i % 3 == 2) p = middle + size * 2 * Vector3d(gauss(rng), gauss(rng), std::abs(gauss(rng)) + 0.5);
    points.push_back({s * p, s * eye});
  }
  std::shuffle(points.begin(), points.end(), rng);
  return points;
}

/// The largest error of a vertex, in sizes of the mesh.
double errorOf(const Registration& r, const Similarity& truth, const TriangleMesh& mesh) {
  double most = 0;
  for (const Vector3d& v : mesh.vertices) most = std::max(most, (r.pointsFromMesh * v - truth * v).norm());
  return most / r.size;
}

TEST(RegisterMesh, FindsAnyTurnExactly) {
  const TriangleMesh mesh = body(lump);
  for (unsigned seed = 1; seed <= 3; ++seed) {
    const Similarity truth = anySimilarity(seed, 1.7);
    const Outcome<Registration> r = registerMesh(mesh, cloudOf(mesh, truth, {}));
    ASSERT_TRUE(r) << r.failure().message();
    EXPECT_LT(errorOf(*r, truth, mesh), 1e-6) << r->text();
    EXPECT_EQ(r->explained, 200u);
    EXPECT_EQ(r->alike, 0);
    EXPECT_LT(r->second, 120u) << r->text();
  }
}

TEST(RegisterMesh, Scale) {
  const TriangleMesh mesh = body(lump);
  for (const double scale : {1e-3, 1e3}) {
    const Similarity truth = anySimilarity(7, scale);
    const Outcome<Registration> r = registerMesh(mesh, cloudOf(mesh, truth, {}));
    ASSERT_TRUE(r) << r.failure().message();
    EXPECT_LT(errorOf(*r, truth, mesh), 1e-6) << scale << " " << r->text();
  }
}

TEST(RegisterMesh, NoiseOfTheExpectedSize) {
  // 200 points that scatter by 0.5 % of the size determine 7 numbers: a corner, 1 size from the middle, to some 0.2 %.
  const TriangleMesh mesh = body(lump);
  for (unsigned seed = 1; seed <= 3; ++seed) {
    const Similarity truth = anySimilarity(20 + seed, 0.3);
    Cloud cloud;
    cloud.noise = 0.01;
    cloud.seed = seed;
    const Outcome<Registration> r = registerMesh(mesh, cloudOf(mesh, truth, cloud));
    ASSERT_TRUE(r) << r.failure().message();
    EXPECT_LT(errorOf(*r, truth, mesh), 4 * r->sigma / r->size) << r->text();
    EXPECT_LT(r->sigma / r->size, 0.01);
    EXPECT_NEAR(r->rms / 0.3, 0.01, 0.003) << "scatter across the surface is that along one axis";
  }
}

TEST(RegisterMesh, PointsOffTheObjectDoNoHarm) {
  const TriangleMesh mesh = body(lump);
  for (unsigned seed = 1; seed <= 3; ++seed) {
    const Similarity truth = anySimilarity(40 + seed, seed % 2 ? 12 : 0.08);
    Cloud cloud;
    cloud.background = 0.5;
    cloud.noise = 0.002;
    cloud.seed = seed;
    const Outcome<Registration> r = registerMesh(mesh, cloudOf(mesh, truth, cloud));
    ASSERT_TRUE(r) << r.failure().message();
    EXPECT_LT(errorOf(*r, truth, mesh), 0.01) << r->text();
  }
}

TEST(RegisterMesh, OneSideOfTheObjectIsEnough) {
  const TriangleMesh mesh = body(lump);
  for (unsigned seed = 1; seed <= 3; ++seed) {
    const Similarity truth = anySimilarity(60 + seed, 2);
    Cloud cloud;
    cloud.cameras = 60;
    cloud.background = 0.3;
    cloud.seed = seed;
    const Outcome<Registration> r = registerMesh(mesh, cloudOf(mesh, truth, cloud));
    ASSERT_TRUE(r) << r.failure().message();
    EXPECT_LT(errorOf(*r, truth, mesh), 1e-4) << r->text();
  }
}

/// The triangles of a mesh on one side of a plane through the lump's middle.
TriangleMesh partOf(const TriangleMesh& whole, const Vector3d& outwards, double offset) {
  TriangleMesh part = whole;
  std::erase_if(part.triangles, [&](const Eigen::Vector3i& t) {
    return (whole.vertices[std::size_t(t[0])] - Vector3d(0.2, -0.1, 1.3)).dot(outwards.normalized()) < offset;
  });
  return part;
}

// Most points lie on what the mesh does not show. Where those beside its border drew it, both were ambiguous.
TEST(RegisterMesh, AScanOfOnePartOfTheObjectIsFound) {
  const TriangleMesh whole = body(lump);
  struct Row {
    Vector3d outwards;
    double offset, most, background;
    unsigned seed;
  };
  for (const Row& row : {Row{{-0.882, -0.125, 0.454}, 0.12, 0.45, 0, 11}, Row{{0.118, -0.112, 0.987}, 0.24, 0.36, 0.3, 12}}) {
    const TriangleMesh part = partOf(whole, row.outwards, row.offset);
    ASSERT_LT(double(part.triangles.size()), row.most * double(whole.triangles.size()));
    Cloud cloud;
    cloud.onObject = 250;
    cloud.noise = 0.003;
    cloud.background = row.background;
    cloud.seed = row.seed;
    const Similarity truth = anySimilarity(99 + row.seed, 0.7);
    const Outcome<Registration> r = registerMesh(part, cloudOf(whole, truth, cloud));
    ASSERT_TRUE(r) << r.failure().message();
    EXPECT_LT(errorOf(*r, truth, part), 4 * r->sigma / r->size) << r->text();
    EXPECT_LT(r->sigma / r->size, 0.01);
  }
}

// Points beside the border drew the mesh away even from where it belongs.
TEST(RegisterMesh, ASmallPartIsNeverPutElsewhere) {
  const TriangleMesh whole = body(lump);
  Cloud cloud;
  cloud.noise = 0.003;
  cloud.background = 0.3;
  for (unsigned seed = 1; seed <= 2; ++seed) {
    cloud.seed = seed;
    const TriangleMesh part = partOf(whole, Vector3d(1, seed, -0.5), 0.2);
    const Similarity truth = anySimilarity(80 + seed, 0.7);
    const Outcome<Registration> r = registerMesh(part, cloudOf(whole, truth, cloud));
    if (r)
      EXPECT_LT(errorOf(*r, truth, part), 4 * r->sigma / r->size) << r->text();
    else
      EXPECT_THAT(r.failure().reason, testing::AnyOf(Reason::NotConverged, Reason::RankDeficient)) << r.failure().message();
  }
}

// Who saw a point is not always known: the nearest camera that has it in its image may be on the far side of the object.
TEST(RegisterMesh, APointIsHiddenOnlyWhereItIsFromAllThatMayHaveSeenIt) {
  const TriangleMesh mesh = body(lump);
  const Similarity truth = anySimilarity(31, 0.5);
  std::vector<SeenPoint> points = cloudOf(mesh, truth, {});
  const Vector3d middle = truth * Vector3d(0.2, -0.1, 1.3);
  for (std::size_t i = 0; i < points.size(); i += 3) {  // from the opposite side, through the object
    points[i].orEyes = {points[i].eye};
    points[i].eye = 2 * middle - points[i].eye;
  }
  const Outcome<Registration> r = registerMesh(mesh, points);
  ASSERT_TRUE(r) << r.failure().message();
  EXPECT_LT(errorOf(*r, truth, mesh), 1e-6) << r->text();
  EXPECT_EQ(r->hidden, 0u);
  for (SeenPoint& p : points) p.orEyes.clear();
  const Outcome<Registration> hidden = registerMesh(mesh, points);
  ASSERT_FALSE(hidden) << hidden->text();
  EXPECT_THAT(hidden.failure().detail, HasSubstr("hides"));
}

TEST(RegisterMesh, ASymmetricShapeIsTheSameSurfaceTurned) {
  const TriangleMesh mesh = body(ellipsoid);
  const Similarity truth = anySimilarity(9, 4);
  const Outcome<Registration> r = registerMesh(mesh, cloudOf(mesh, truth, {}));
  ASSERT_TRUE(r) << r.failure().message();
  EXPECT_GE(r->alike, 1) << r->text();
  const Similarity self = truth.inverse() * r->pointsFromMesh;  // one of the four turns of an ellipsoid
  EXPECT_NEAR(self.scale, 1, 1e-6);
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(std::abs(self.rotation(k, k)), 1, 1e-6);
  EXPECT_THAT(r->text(), HasSubstr("symmetric"));
}

TEST(RegisterMesh, ABallIsAmbiguous) {
  const TriangleMesh mesh = body(ball);
  const Outcome<Registration> r = registerMesh(mesh, cloudOf(mesh, anySimilarity(3, 2), {}));
  ASSERT_FALSE(r) << r->text();
  EXPECT_EQ(r.failure().reason, Reason::RankDeficient);
  EXPECT_THAT(r.failure().detail, HasSubstr("ambiguous"));
}

TEST(RegisterMesh, AnotherObjectIsRefused) {
  const TriangleMesh mesh = body(lump), other = body([](const Vector3d&d) {
                                          return Vector3d(d.array().sign() * d.array().abs().pow(0.3) *
                                                          Vector3d(1, 0.2, 0.6).array());  // nearly a box
                                        });
  Cloud cloud;
  cloud.background = 0.3;
  const Outcome<Registration> r = registerMesh(mesh, cloudOf(other, anySimilarity(4, 1), cloud));
  EXPECT_FALSE(r) << r->text();
}

TEST(RegisterMesh, PointsWithoutTheObjectAreRefused) {
  const TriangleMesh mesh = body(lump);
  std::mt19937_64 rng(1);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<SeenPoint> points;
  for (int i = 0; i < 400; ++i) points.push_back({{uniform(rng), uniform(rng), uniform(rng)}, {5, uniform(rng), 0}});
  const Outcome<Registration> anywhere = registerMesh(mesh, points);
  EXPECT_FALSE(anywhere) << anywhere->text();
  for (SeenPoint& p : points) p.point.z() = 0;
  const Outcome<Registration> flat = registerMesh(mesh, points);
  EXPECT_FALSE(flat) << flat->text();
}

TEST(RegisterMesh, TooFewPointsAreRefusedByName) {
  const TriangleMesh mesh = body(lump);
  Cloud cloud;
  cloud.onObject = 19;
  const Outcome<Registration> r = registerMesh(mesh, cloudOf(mesh, anySimilarity(1, 1), cloud));
  ASSERT_FALSE(r);
  EXPECT_EQ(r.failure().reason, Reason::TooFewPoints);
}

TEST(RegisterMesh, WhatIsNotFiniteIsRefusedByName) {
  const TriangleMesh mesh = body(lump);
  std::vector<SeenPoint> points = cloudOf(mesh, {}, {});
  points[7].point.x() = std::nan("");
  const Outcome<Registration> r = registerMesh(mesh, points);
  ASSERT_FALSE(r);
  EXPECT_EQ(r.failure().reason, Reason::NotFinite);
  points = cloudOf(mesh, {}, {});
  points[7].orEyes = {{0, std::nan(""), 0}};
  EXPECT_EQ(registerMesh(mesh, points).failure().reason, Reason::NotFinite);
}

}  // namespace
}  // namespace glint::registration_tests
