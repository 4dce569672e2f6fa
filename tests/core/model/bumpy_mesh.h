// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>
#include <utility>
#include <vector>

#include "core/surface/analytic.h"

/// Photogrammetry's meshes: right but for smooth bumps.
namespace glint::test {

/// A mesh of an analytic shape, its vertices moved along the shape's normals by a sum of waves. The mesh's normals are its own:
/// those of the bumps.
/// @param slope   RMS slope of the bumps in one direction, rad. @param length  their wavelength over two pi, m.
inline TriangleMesh bumpyMesh(const AnalyticSpec& spec, double slope, double length, unsigned seed, int resolution = 160) {
  TriangleMesh mesh = makeAnalytic(spec)->tessellate(Eigen::AlignedBox3d(), resolution);
  std::mt19937 rng(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> phase(0, 2 * M_PI);
  constexpr int kWaves = 16;
  std::vector<std::pair<Eigen::Vector3d, double>> waves;
  for (int i = 0; i < kWaves; ++i) {
    Eigen::Vector3d k;  // one number after the other: compilers differ in the order in which they evaluate arguments
    const double f = phase(rng);
    for (const int axis : {2, 1, 0}) k(axis) = normal(rng);
    waves.emplace_back(k / length, f);
  }
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    double h = 0;
    for (const auto& [k, f] : waves) h += slope * length * std::sqrt(2.0 / kWaves) * std::sin(k.dot(mesh.vertices[i]) + f);
    mesh.vertices[i] += h * mesh.normals[i];
  }
  mesh.normals.clear();
  return mesh;
}

/// Text PLY with every digit of the vertices; no normals.
inline void writePly(const TriangleMesh& mesh, const std::filesystem::path& file) {
  std::ofstream ply(file);
  ply.precision(17);
  ply << "ply\nformat ascii 1.0\nelement vertex " << mesh.vertices.size()
      << "\nproperty double x\nproperty double y\nproperty double z\nelement face " << mesh.triangles.size()
      << "\nproperty list uchar int vertex_indices\nend_header\n";
  for (const Eigen::Vector3d& v : mesh.vertices) ply << v.x() << " " << v.y() << " " << v.z() << "\n";
  for (const Eigen::Vector3i& t : mesh.triangles) ply << "3 " << t.x() << " " << t.y() << " " << t.z() << "\n";
}

}  // namespace glint::test
