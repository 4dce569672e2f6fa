// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// A mesh of another frame and unit, and the sparse points that cameras saw of it.

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <random>

#include "core/surface/mesh.h"
#include "core/surface/registration.h"

namespace glint::registration_tests {

/// A closed body of `shape`(unit direction) -> radius, of 2 rings^2 triangles or so.
template <class Shape>
TriangleMesh body(const Shape& shape, int rings = 40) {
  TriangleMesh mesh;
  const int sectors = 2 * rings;
  for (int i = 0; i <= rings; ++i)
    for (int k = 0; k < sectors; ++k) {
      const double polar = M_PI * (i == 0 ? 0.001 : i == rings ? rings - 0.001 : i) / rings, around = 2 * M_PI * k / sectors;
      const Eigen::Vector3d d(std::sin(polar) * std::cos(around), std::sin(polar) * std::sin(around), std::cos(polar));
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
inline Eigen::Vector3d lump(const Eigen::Vector3d& d) {
  const auto bump = [&](const Eigen::Vector3d& at, double height, double width) {
    return height * std::exp((d.dot(at.normalized()) - 1) / (width * width));
  };
  const double r = 1 + bump({1, 0.2, 0.3}, 0.5, 0.35) + bump({-0.3, 1, -0.5}, -0.25, 0.5) + bump({0.1, -0.8, 0.9}, 0.3, 0.4);
  return {0.7 * r * d.x() + 0.2, 0.5 * r * d.y() - 0.1, 0.4 * r * d.z() + 1.3};
}
inline Eigen::Vector3d ball(const Eigen::Vector3d& d) { return 0.5 * d + Eigen::Vector3d(0.3, 0, 0.1); }
inline Eigen::Vector3d ellipsoid(const Eigen::Vector3d& d) { return {0.21 * d.x(), 0.155 * d.y(), 0.115 * d.z()}; }

inline Similarity anySimilarity(unsigned seed, double scale) {
  std::mt19937_64 rng(seed);
  std::normal_distribution<double> gauss;
  const Eigen::Quaterniond q = Eigen::Quaterniond(gauss(rng), gauss(rng), gauss(rng), gauss(rng)).normalized();
  return {scale, q.toRotationMatrix(), scale * Eigen::Vector3d(3 * gauss(rng), 3 * gauss(rng), 3 * gauss(rng))};
}

struct Cloud {
  int onObject = 200;
  double noise = 0;       ///< along each axis, in mesh units
  double background = 0;  ///< share of all points
  double cameras = 300;   ///< degrees of a turn about the object that the cameras take
  unsigned seed = 1;
};

/// What a structure-from-motion program would leave: points of triangles that look at a camera, and of a floor and walls around.
inline std::vector<SeenPoint> cloudOf(const TriangleMesh& mesh, const Similarity& s, const Cloud& c) {
  std::mt19937_64 rng(c.seed);
  std::normal_distribution<double> gauss;
  std::uniform_real_distribution<double> uniform;
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& v : mesh.vertices) box.extend(v);
  const Eigen::Vector3d middle = box.center();
  const double size = box.sizes().norm();
  std::vector<Eigen::Vector3d> eyes;
  for (int i = 0; i < 24; ++i) {
    const double a = c.cameras * M_PI / 180 * i / 24;
    eyes.push_back(middle + 2.5 * size * Eigen::Vector3d(std::cos(a), std::sin(a), 0.4));
  }
  const std::shared_ptr<const Surface> surface = makeMesh(mesh, MeshPolicy{NormalPolicy::Facet}, false);
  std::vector<SeenPoint> points;
  const auto noisy = [&](const Eigen::Vector3d& p) {
    return Eigen::Vector3d(p + c.noise * Eigen::Vector3d(gauss(rng), gauss(rng), gauss(rng)));
  };
  while (static_cast<int>(points.size()) < c.onObject) {
    const Eigen::Vector3i t = mesh.triangles[std::size_t(uniform(rng) * double(mesh.triangles.size()))];
    const Eigen::Vector3d a = mesh.vertices[std::size_t(t[0])], b = mesh.vertices[std::size_t(t[1])],
                          d = mesh.vertices[std::size_t(t[2])];
    const Eigen::Vector3d eye = eyes[std::size_t(uniform(rng) * 24)], outwards = (b - a).cross(d - a).normalized();
    const double u = uniform(rng), v = uniform(rng) * (1 - u);
    const Eigen::Vector3d p = a + u * (b - a) + v * (d - a);
    const Eigen::Vector3d towards = (eye - p).normalized();
    if (outwards.dot(towards) < 0.2 || surface->firstHit({p + 1e-6 * size * towards, towards})) continue;  // it is not seen
    points.push_back({s * noisy(p), s * eye});
  }
  const int behind = static_cast<int>(c.background / (1 - c.background) * c.onObject);
  for (int i = 0; i < behind; ++i) {
    const Eigen::Vector3d eye = eyes[std::size_t(uniform(rng) * 24)];
    Eigen::Vector3d p = middle + size * Eigen::Vector3d(4 * uniform(rng) - 2, 4 * uniform(rng) - 2, -0.55);  // a floor
    if (i % 3 == 1) p = middle + size * Eigen::Vector3d(2 * (2 * uniform(rng) - 1), 2.2, 2 * uniform(rng));  // a wall
    if (i % 3 == 2) p = middle + size * 2 * Eigen::Vector3d(gauss(rng), gauss(rng), std::abs(gauss(rng)) + 0.5);
    points.push_back({s * p, s * eye});
  }
  std::shuffle(points.begin(), points.end(), rng);
  return points;
}

}  // namespace glint::registration_tests
