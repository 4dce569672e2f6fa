// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "core/surface/analytic.h"
#include "core/surface/mesh.h"
#include "tests/stability/cases.h"
#include "tests/stability/fifty_digits.h"
#include "tests/stability/real.h"

namespace glint::stability {
namespace {

/// A tessellated ellipsoid of 1 m times `scale`, at an offset.
TriangleMesh meshOf(double scale, const Eigen::Vector3d& offset) {
  AnalyticSpec s;
  s.type = "ellipsoid";
  s.semiAxes = scale * Eigen::Vector3d(1, 0.7, 0.5);
  s.worldFromSurface.translation() = offset;
  TriangleMesh mesh = makeAnalytic(s)->tessellate({}, 24);
  mesh.normals.clear();
  return mesh;
}

/// Nearest intersection with any triangle, by signed volumes in fifty digits: brute force over the clean mesh.
std::optional<Vec<Real>> firstHit(const TriangleMesh& mesh, const Ray& ray) {
  const Vec<Real> o = exactly<Real>(ray.origin), d = exactly<Real>(ray.direction);
  std::optional<Real> best;
  for (const Eigen::Vector3i& t : mesh.triangles) {
    const Vec<Real> a = exactly<Real>(mesh.vertices[t.x()]) - o, b = exactly<Real>(mesh.vertices[t.y()]) - o,
                    c = exactly<Real>(mesh.vertices[t.z()]) - o;
    const Real u = dot(d, cross(c, b)), v = dot(d, cross(a, c)), w = dot(d, cross(b, a));
    if (!((u >= 0 && v >= 0 && w >= 0) || (u <= 0 && v <= 0 && w <= 0)) || u + v + w == 0) continue;
    const Vec<Real> n = cross(b - a, c - a);
    const Real s = dot(a, n) / dot(d, n);
    if (s > 0 && (!best || s < *best)) best = s;
  }
  if (!best) return std::nullopt;
  return o + *best * d;
}

using Damage = std::function<void(TriangleMesh&)>;

/// Rays on a damaged mesh against brute force on the clean one: worst position, over the mesh's size.
Outcome<Measured> rayCase(double scale, const Eigen::Vector3d& offset, const Damage& damage, double condition) {
  const TriangleMesh clean = meshOf(scale, offset);
  TriangleMesh broken = clean;
  if (damage) damage(broken);
  const auto surface = makeMesh(broken, NormalPolicy::Interpolated);
  double worst = 0;
  for (int i = 0; i < 40; ++i) {
    const double a = 0.7 * i, b = 0.37 * i;
    const Eigen::Vector3d from = offset + scale * Eigen::Vector3d(3 * std::cos(a), 3 * std::sin(a), 2 * std::cos(b));
    const Eigen::Vector3d to = offset + scale * 0.3 * Eigen::Vector3d(std::sin(3 * b), std::cos(5 * a), std::sin(2 * a));
    const Ray ray{from, (to - from).normalized()};
    const Outcome<SurfacePoint> hit = surface->firstHit(ray);
    const std::optional<Vec<Real>> reference = firstHit(clean, ray);
    if (!reference) continue;
    if (!hit) return hit.failure();
    worst = worstOf({worst, apart(hit->position, *reference) / scale});
  }
  return Measured{worst, condition};
}

/// Turning triangles must not turn normals: the same normals as on the clean mesh, outwards.
Outcome<Measured> normalCase(const Damage& damage) {
  const TriangleMesh clean = meshOf(1, {0, 0, 0});
  TriangleMesh broken = clean;
  damage(broken);
  const auto a = makeMesh(clean, NormalPolicy::Interpolated), b = makeMesh(broken, NormalPolicy::Interpolated);
  double worst = 0;
  for (int i = 0; i < 40; ++i) {
    const Eigen::Vector3d from(3 * std::cos(0.7 * i), 3 * std::sin(0.7 * i), 2 * std::cos(0.37 * i));
    const Ray ray{from, -from.normalized()};
    const Outcome<SurfacePoint> p = a->firstHit(ray), q = b->firstHit(ray);
    if (!p || !q) return (p ? q : p).failure();
    worst = worstOf({worst, (facing(*p, from).normal - facing(*q, from).normal).norm()});
  }
  return Measured{worst};
}

}  // namespace

void addMeshCases(Cases& cases) {
  const auto add = [&](const char* name, double parameter, double tolerance, const char* note, auto run) {
    cases.push_back(answerCase("mesh", name, parameter, tolerance, note, run));
  };
  const Eigen::Vector3d here(0, 0, 0);
  add("scene scale 1e-6", 1e-6, 1e-9, "", [here] { return rayCase(1e-6, here, {}, 1); });
  add("scene scale 1e6", 1e6, 1e-9, "", [here] { return rayCase(1e6, here, {}, 1); });
  add("object of 1 m at 1e6 m from the world's origin", 1e6, 64 * kRound * 1e6, "the vertices' own rounding", [] {
    return rayCase(1, {1e6, -1e6, 5e5}, {}, 1e6);
  });
  add("degenerate triangles (points and needles)", 60, 1e-9, "", [here] {
    return rayCase(
        1, here,
        [](TriangleMesh& m) {
          for (int i = 0; i < 60; ++i) {
            const Eigen::Vector3i t = m.triangles[17 * i % m.triangles.size()];
            m.triangles.emplace_back(t.x(), t.x(), t.y());
            m.vertices.push_back(0.5 * (m.vertices[t.x()] + m.vertices[t.y()]));  // on the edge: an area of round-off
            m.triangles.emplace_back(t.x(), t.y(), int(m.vertices.size()) - 1);
          }
        },
        1);
  });
  add("every triangle three times", 3, 1e-9, "", [here] {
    return rayCase(
        1, here,
        [](TriangleMesh& m) {
          const std::vector<Eigen::Vector3i> once = m.triangles;
          for (int k = 0; k < 2; ++k)
            for (const Eigen::Vector3i& t : once) m.triangles.emplace_back(t.y(), t.z(), t.x());
        },
        1);
  });
  add("a third of the triangles flipped: hits", 3, 1e-9, "", [here] {
    return rayCase(
        1, here,
        [](TriangleMesh& m) {
          for (std::size_t i = 0; i < m.triangles.size(); i += 3) std::swap(m.triangles[i].y(), m.triangles[i].z());
        },
        1);
  });
  add("a third of the triangles flipped: normals", 3, 1e-9, "", [] {
    return normalCase([](TriangleMesh& m) {
      for (std::size_t i = 0; i < m.triangles.size(); i += 3) std::swap(m.triangles[i].y(), m.triangles[i].z());
    });
  });
  add("non-manifold fins on 20 edges", 20, 1e-9, "the fins point inwards, where no ray arrives first", [here] {
    return rayCase(
        1, here,
        [](TriangleMesh& m) {
          for (int i = 0; i < 20; ++i) {
            const Eigen::Vector3i t = m.triangles[31 * i % m.triangles.size()];
            m.vertices.push_back(0.5 * m.vertices[t.x()]);
            m.triangles.emplace_back(t.x(), t.y(), int(m.vertices.size()) - 1);
          }
        },
        1);
  });
  add("every triangle with vertices of its own", 1, 1e-9, "", [here] {
    return rayCase(
        1, here,
        [](TriangleMesh& m) {
          TriangleMesh soup;
          for (const Eigen::Vector3i& t : m.triangles) {
            const int n = int(soup.vertices.size());
            for (int k = 0; k < 3; ++k) soup.vertices.push_back(m.vertices[t[k]]);
            soup.triangles.emplace_back(n, n + 1, n + 2);
          }
          m = soup;
        },
        1);
  });
}

}  // namespace glint::stability
