// SPDX-License-Identifier: BSD-3-Clause
#include "core/surface/smooth_mesh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/surface/analytic.h"

namespace glint::smooth_mesh_tests {
namespace {
using Eigen::Vector3d;

const Vector3d kAxes(0.15, 0.09, 0.07);

/// An ellipsoid as a scanner gives it: every vertex off along the normal, no normals.
TriangleMesh scanned(double noise, double scale = 1, int resolution = 70) {
  AnalyticSpec spec;
  spec.type = "ellipsoid";
  spec.semiAxes = kAxes;
  TriangleMesh mesh = makeAnalytic(spec)->tessellate(Eigen::AlignedBox3d(), resolution);
  std::mt19937_64 rng(5);
  std::normal_distribution<double> gauss;
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
    mesh.vertices[i] = scale * (mesh.vertices[i] + noise * gauss(rng) * mesh.normals[i]);
  mesh.normals.clear();
  return mesh;
}

/// Root mean squares over the flatter sides, of normals and places against the ellipsoid's equation.
struct Off {
  double normal = 0, place = 0;
};
Off offFrom(const TriangleMesh& mesh, double scale = 1) {
  Off off;
  double count = 0;
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const Vector3d p = mesh.vertices[i] / scale, gradient = p.cwiseQuotient(kAxes.cwiseAbs2());
    if (std::abs(p.z()) < 0.5 * kAxes.z() || mesh.normals[i].isZero()) continue;  // repeats of a pole are in no triangle
    const double height = (p.dot(gradient) - 1) / (2 * gradient.norm());
    off.normal += 1 - std::pow(mesh.normals[i].dot(gradient.normalized()), 2);
    off.place += height * height;
    ++count;
  }
  return {std::sqrt(off.normal / count), std::sqrt(off.place / count)};
}

// Without noise, what a quadric cannot follow is left: slopes of third order in the radius.
TEST(MeshSmoother, AnExactMeshStaysWhereItIs) {
  const MeshSmoother smoother(scanned(0));
  const double radius = 3 * smoother.spacing();
  const SmoothMesh smooth = smoother.at(radius);
  const Off off = offFrom(smooth.mesh);
  EXPECT_LT(off.normal, 0.004);
  EXPECT_LT(off.place, 2e-5);
  EXPECT_LT(smooth.noise, 1e-5);
  EXPECT_LT(smooth.normalNoise, 0.002);
}

// The truth is the noise that was added.
TEST(MeshSmoother, FindsTheNoiseAndTakesItOut) {
  for (const double noise : {2e-4, 1e-3}) {
    const MeshSmoother smoother(scanned(noise, 1, 100));
    const SmoothMesh smooth = smoother.at(noise > 5e-4 ? 0.035 : 0.02);
    const Off off = offFrom(smooth.mesh);
    EXPECT_NEAR(smooth.noise, noise, 0.1 * noise);
    EXPECT_LT(off.normal, noise > 5e-4 ? 0.03 : 0.012);
    EXPECT_LT(off.place, 0.4 * noise);
    EXPECT_GT(2 * off.normal, smooth.normalNoise);
  }
}

TEST(MeshSmoother, HasNoUnit) {
  const MeshSmoother one(scanned(1e-3)), large(scanned(1e-3, 1e4));
  const SmoothMesh a = one.at(0.03), b = large.at(300);
  EXPECT_NEAR(b.noise, 1e4 * a.noise, 1e-6 * b.noise);
  EXPECT_NEAR(b.normalNoise, a.normalNoise, 1e-6);
  EXPECT_NEAR(offFrom(b.mesh, 1e4).normal, offFrom(a.mesh).normal, 1e-6);
  EXPECT_NEAR(large.spacing(), 1e4 * one.spacing(), 1e-6 * large.spacing());
}

// Two walls nearer to each other than the radius: neither bends the other.
TEST(MeshSmoother, TheOtherSideOfAThinSheetDoesNotCount) {
  TriangleMesh mesh;
  constexpr int kSide = 20;
  constexpr double kStep = 0.01, kThick = 0.03;
  for (const double z : {0.0, -kThick})
    for (int j = 0; j < kSide; ++j)
      for (int i = 0; i < kSide; ++i) mesh.vertices.emplace_back(i * kStep, j * kStep, z);
  for (int side = 0; side < 2; ++side)
    for (int j = 0; j + 1 < kSide; ++j)
      for (int i = 0; i + 1 < kSide; ++i) {
        const int a = side * kSide * kSide + j * kSide + i, b = a + 1, c = a + kSide, d = c + 1;
        if (side == 0) mesh.triangles.insert(mesh.triangles.end(), {{a, b, d}, {a, d, c}});
        if (side == 1) mesh.triangles.insert(mesh.triangles.end(), {{a, d, b}, {a, c, d}});
      }
  const SmoothMesh smooth = MeshSmoother(mesh).at(2 * kThick);
  for (std::size_t i = 0; i < smooth.mesh.vertices.size(); ++i) {
    const bool upper = i < kSide * kSide;
    EXPECT_NEAR(smooth.mesh.vertices[i].z(), upper ? 0 : -kThick, 1e-12) << i;
    EXPECT_NEAR(smooth.mesh.normals[i].z(), upper ? 1 : -1, 1e-12) << i;
  }
}

TEST(MeshSmoother, WhatDeterminesNoQuadricStays) {
  EXPECT_EQ(MeshSmoother(TriangleMesh{}).spacing(), 0);
  EXPECT_TRUE(MeshSmoother(TriangleMesh{}).at(1).mesh.vertices.empty());
  EXPECT_THROW((void)MeshSmoother(scanned(0)).at(0), std::invalid_argument);
  TriangleMesh few;
  few.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {5, 5, 5}};
  few.triangles = {{0, 1, 2}};
  few.normals = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {1, 0, 0}};
  const SmoothMesh one = MeshSmoother(few).at(3);
  EXPECT_EQ(one.mesh.vertices, few.vertices);
  EXPECT_EQ(one.mesh.normals, few.normals);
  EXPECT_EQ(one.noise, 0);
  // Fewer vertices within the radius than a quadric needs.
  const TriangleMesh given = scanned(1e-3);
  EXPECT_EQ(MeshSmoother(given).at(1e-4).mesh.vertices, given.vertices);
}

}  // namespace
}  // namespace glint::smooth_mesh_tests
