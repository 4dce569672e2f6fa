// SPDX-License-Identifier: BSD-3-Clause
#include "core/surface/registration.h"

#include <gmock/gmock.h>

#include <cmath>

#include "tests/core/surface/registration_fixture.h"

namespace glint::registration_tests {
namespace {
using Eigen::Vector3d;
using testing::HasSubstr;

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
