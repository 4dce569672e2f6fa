// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "core/base/bytes.h"
#include "core/report/share_parts.h"

namespace glint::share_surface_tests {
namespace {

using share::packed;
using share::simplified;

constexpr std::size_t kMost = 2000;

/// A sphere of rings and columns about the origin: 2 * columns * (rings - 1) triangles without those at the poles that vanish.
TriangleMesh sphere(double radius, int rings = 100, int columns = 200) {
  TriangleMesh mesh;
  for (int i = 0; i <= rings; ++i)
    for (int j = 0; j < columns; ++j) {
      const double theta = std::numbers::pi * i / rings, phi = 2 * std::numbers::pi * j / columns;
      mesh.normals.emplace_back(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta));
      mesh.vertices.push_back(radius * mesh.normals.back());
    }
  for (int i = 0; i < rings; ++i)
    for (int j = 0; j < columns; ++j) {
      const int a = i * columns + j, b = i * columns + (j + 1) % columns, c = a + columns, d = b + columns;
      mesh.triangles.emplace_back(a, c, b);
      mesh.triangles.emplace_back(b, c, d);
    }
  return mesh;
}

void expectSphere(const TriangleMesh& mesh, double radius) {
  EXPECT_LE(mesh.triangles.size(), kMost);
  EXPECT_GT(mesh.triangles.size(), kMost / 3);
  ASSERT_EQ(mesh.normals.size(), mesh.vertices.size());
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    // A cell is about a tenth of the radius wide, so the mean of its vertices lies at most a chord's height inside.
    EXPECT_NEAR(mesh.vertices[i].norm(), radius, 0.02 * radius);
    EXPECT_GT(mesh.normals[i].normalized().dot(mesh.vertices[i].normalized()), 0.99);
  }
}

TEST(SimplifiedSurface, NominalASphereStaysOne) { expectSphere(simplified(sphere(1), kMost), 1); }

TEST(SimplifiedSurface, ScaleChangesNothingElse) {
  const TriangleMesh one = simplified(sphere(1), kMost);
  for (const double scale : {1.0 / 1024, 1024.0}) {  // powers of two: the same bits
    const TriangleMesh other = simplified(sphere(scale), kMost);
    EXPECT_EQ(other.triangles, one.triangles) << scale;
    expectSphere(other, scale);
  }
}

TEST(SimplifiedSurface, NoiseLeavesASphere) {
  std::mt19937 random(5);
  std::normal_distribution<double> noise(0, 0.003);
  TriangleMesh mesh = sphere(1);
  for (Eigen::Vector3d& v : mesh.vertices) v += Eigen::Vector3d(noise(random), noise(random), noise(random));
  expectSphere(simplified(mesh, kMost), 1);
}

TEST(SimplifiedSurface, DegenerateMeshesLoseWhatCannotBeDrawn) {
  EXPECT_TRUE(simplified({}, kMost).triangles.empty());
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {std::nan(""), 0, 0}, {9, 9, 9}};
  mesh.triangles = {{0, 1, 2}, {0, 1, 3}, {0, 1, 7}, {-1, 0, 1}};
  const TriangleMesh drawn = simplified(mesh, kMost);
  ASSERT_EQ(drawn.triangles.size(), 1U);
  EXPECT_EQ(drawn.triangles[0], Eigen::Vector3i(0, 1, 2));
  EXPECT_EQ(drawn.vertices.size(), 3U);  // nor the vertex that no triangle has, which would widen the box
  // All vertices in one place: nothing to see, and an end.
  TriangleMesh point = sphere(0);
  EXPECT_LE(simplified(point, kMost).triangles.size(), kMost);
}

TEST(PackedSurface, PositionsAreExactToHalfAStep) {
  const TriangleMesh mesh = sphere(3, 8, 12);
  const std::string json = "{" + packed(mesh, 5) + "}";
  const auto field = [&](const std::string& key) {
    const std::size_t from = json.find("\"" + key + "\":\"") + key.size() + 4;
    return *fromBase64(json.substr(from, json.find('"', from) - from));
  };
  const std::string positions = field("positions"), indices = field("indices");
  ASSERT_EQ(positions.size(), 6 * mesh.vertices.size());
  ASSERT_EQ(indices.size(), 12 * mesh.triangles.size());
  const double step = 6.0 / 65535;  // of z, from -3 to 3
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const auto byte = [&](std::size_t k) { return static_cast<unsigned char>(positions[6 * i + k]); };
    EXPECT_NEAR(-3 + step * (byte(4) + 256 * byte(5)), mesh.vertices[i].z(), 0.5001 * step);
  }
}

TEST(PackedSurface, AFlatOrEmptyMeshHasNoNaN) {
  TriangleMesh flat;
  flat.vertices = {{0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
  flat.normals.assign(3, Eigen::Vector3d::Zero());
  flat.triangles = {{0, 1, 2}};
  for (const TriangleMesh& mesh : {flat, TriangleMesh{}}) {
    const std::string json = packed(mesh, 1);
    EXPECT_EQ(json.find("nan"), std::string::npos) << json;
    EXPECT_EQ(json.find("inf"), std::string::npos) << json;
    EXPECT_EQ(json.find("null"), std::string::npos) << json;
  }
}

}  // namespace
}  // namespace glint::share_surface_tests
