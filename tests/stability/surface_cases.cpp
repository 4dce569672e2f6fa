// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "core/surface/analytic.h"
#include "tests/stability/cases.h"
#include "tests/stability/fifty_digits.h"
#include "tests/stability/real.h"

namespace glint::stability {
namespace {

/// x^T A x + 2 b.x + c with diagonal A: every analytic quadric in its own frame.
struct RealQuadric {
  Vec<Real> a, b;
  Real c;
  Real value(const Vec<Real>& p) const { return dot(p, scaled(p)) + 2 * dot(b, p) + c; }
  Vec<Real> gradient(const Vec<Real>& p) const { return scaled(p) + b; }
  Vec<Real> scaled(const Vec<Real>& p) const { return {a.x * p.x, a.y * p.y, a.z * p.z}; }
  /// First positive root along a ray, the textbook formula.
  std::optional<Vec<Real>> firstHit(const Vec<Real>& o, const Vec<Real>& d) const {
    const Real qa = dot(d, scaled(d)), qb = dot(d, scaled(o)) + dot(b, d), qc = value(o);
    std::optional<Real> best;
    const auto offer = [&](const Real& t) {
      if (t > 0 && (!best || t < *best)) best = t;
    };
    if (qa == 0) {
      offer(-qc / (2 * qb));
    } else {
      const Real disc = qb * qb - qa * qc;
      if (disc < 0) return std::nullopt;
      offer((-qb - sqrt(disc)) / qa);
      offer((-qb + sqrt(disc)) / qa);
    }
    if (!best) return std::nullopt;
    return o + *best * d;
  }
};
RealQuadric sheetOf(double k) { return {{Real(k), Real(0), Real(k)}, {Real(0), Real(0), Real(1)}, Real(0)}; }
RealQuadric saddleOf(double k) { return {{Real(k), Real(-k), Real(0)}, {Real(0), Real(0), Real(1)}, Real(0)}; }
RealQuadric sphereOf(double r) {
  const Real i = 1 / (Real(r) * r);
  return {{i, i, i}, {Real(0), Real(0), Real(0)}, Real(-1)};
}
AnalyticSpec sheet(double k) {
  AnalyticSpec s;
  s.type = "sheet";
  s.curvature = k;
  return s;
}
AnalyticSpec sphere(double r) {
  AnalyticSpec s;
  s.type = "sphere";
  s.radius = r;
  return s;
}
AnalyticSpec saddle(double k) {
  AnalyticSpec s;
  s.type = "quadric";
  s.matrix.diagonal() << k, -k, 0, 0;
  s.matrix(2, 3) = s.matrix(3, 2) = 1;
  return s;
}

/// Position (over the distance of the eye) and normal of the first hit.
Outcome<Measured> hitCase(const AnalyticSpec& spec, const RealQuadric& quadric, const Eigen::Vector3d& from,
                          const Eigen::Vector3d& to, double condition) {
  const Ray ray{from, (to - from).normalized()};
  const std::optional<Vec<Real>> reference = quadric.firstHit(exactly<Real>(ray.origin), exactly<Real>(ray.direction));
  const Outcome<SurfacePoint> hit = makeAnalytic(spec)->firstHit(ray);
  if (!hit) return hit.failure();
  if (!reference) return Measured{1, condition};
  Vec<Real> n = unit(quadric.gradient(*reference));
  if (dot(n, exactly<Real>(hit->normal)) < 0) n = Real(-1) * n;
  const double distance = static_cast<double>(length(*reference - exactly<Real>(from)));
  return Measured{worstOf({apart(hit->position, *reference) / distance, apart(hit->normal, n)}), condition};
}

/// Foot along a direction: of the two intersections of the line the one nearest to `previous`.
Outcome<Measured> footCase(const AnalyticSpec& spec, const RealQuadric& quadric, const Eigen::Vector3d& point,
                           const Eigen::Vector3d& direction, const Eigen::Vector3d& previous, double size) {
  const Eigen::Vector3d d = direction.normalized();
  const Outcome<SurfacePoint> foot = makeAnalytic(spec)->foot(point, d, {previous, {0, 0, 1}});
  if (!foot) return foot.failure();
  std::optional<Vec<Real>> best;
  for (const double sign : {1.0, -1.0}) {
    const auto p = quadric.firstHit(exactly<Real>(point), Real(sign) * exactly<Real>(d));
    if (p && (!best || length(*p - exactly<Real>(previous)) < length(*best - exactly<Real>(previous)))) best = p;
  }
  if (!best) return Measured{1};
  return Measured{apart(foot->position, *best) / size};
}

/// Principal curvatures of z = -(k / 2)(x^2 - y^2) in closed form: roots of t^2 - 2 H t + K.
Outcome<Measured> curvatureCase(double k, double x, double y) {
  const Real rk = k, p = -rk * x, q = rk * y, g = 1 + p * p + q * q;  // z_x, z_y; z_xx = -k, z_yy = k
  const Real gauss = -rk * rk / (g * g), mean = ((1 + q * q) * -rk + (1 + p * p) * rk) / (2 * g * sqrt(g));
  const Real root = sqrt(mean * mean - gauss);
  const double z = -0.5 * k * (x * x - y * y);
  const auto surface = makeAnalytic(saddle(k));
  const Outcome<SurfacePoint> on = surface->foot({x, y, z}, {0, 0, 1}, {{x, y, z}, {0, 0, 1}});
  if (!on) return on.failure();
  const Outcome<Curvature> c = surface->curvatureAt(*on);
  if (!c) return c.failure();
  // The stored normal is along +z, where bending away is convex: z_xx < 0 is positive.
  const Real k1 = -mean + root, k2 = -mean - root;
  return Measured{worstOf({static_cast<double>(abs(Real(c->k1) / k1 - 1)), static_cast<double>(abs(Real(c->k2) / k2 - 1))})};
}

}  // namespace

void addSurfaceCases(Cases& cases) {
  const auto add = [&](const std::string& name, double parameter, double tolerance, const char* note, auto run) {
    cases.push_back(answerCase("surface", name, parameter, tolerance, note, run));
  };
  for (const double k : {1e-9, 1e-3, 1e3})
    add("ray on a sheet of curvature " +
            std::string(k == 1e-9   ? "1e-9"
                        : k == 1e-3 ? "1e-3"
                                    : "1e3") +
            " per metre",
        k, 1e-9, "", [k] {
          return hitCase(sheet(k), sheetOf(k), {0.3, -0.4, 1.2}, {k > 1 ? 0.4 / k : 0.1, 0.2, 0}, 1 + k);
        });
  add("ray that misses the centre of a sphere by 1 - 1e-10 radii", 1e-10, 1e-9, "", [] {
    return hitCase(sphere(1), sphereOf(1), {1 - 1e-10, 0, 3}, {1 - 1e-10, 0, 0}, 1 / std::sqrt(2e-10));
  });
  add("sphere of 1e6 m seen from 1e6 m above", 1e6, 1e-9, "", [] {
    return hitCase(sphere(1e6), sphereOf(1e6), {1e5, 2e5, 2e6}, {3e5, -2e5, 0}, 1);
  });
  add("sphere of 1e-6 m seen from 1e-6 m above", 1e-6, 1e-9, "", [] {
    return hitCase(sphere(1e-6), sphereOf(1e-6), {1e-7, 2e-7, 2e-6}, {3e-7, -2e-7, 0}, 1);
  });
  add("sphere of 1e-3 m seen from 1,000 m", 1e6, 1e-9, "relative to the distance; 1e-13 of it is 1e-7 of the radius", [] {
    return hitCase(sphere(1e-3), sphereOf(1e-3), {100, 200, 970}, {3e-4, -2e-4, 0}, 1e6);
  });
  add("saddle, ray at 89.9 degrees", 89.9, 1e-9, "", [] {
    return hitCase(saddle(0.5), saddleOf(0.5), {-2, 0.05, 0.5}, {0.05, 0.04, 0}, 1 / std::cos(1.569));
  });
  add("foot on a sheet of curvature 1e-9 per metre", 1e-9, 1e-9, "", [] {
    return footCase(sheet(1e-9), sheetOf(1e-9), {0.3, 0.2, 0.01}, {0.1, 0.05, 1}, {0, 0, 0}, 1);
  });
  add("foot on a sheet of curvature 1e3 per metre", 1e3, 1e-9, "", [] {
    return footCase(sheet(1e3), sheetOf(1e3), {3e-4, 2e-4, 1e-5}, {0.1, 0.05, 1}, {0, 0, 0}, 1e-3);
  });
  for (const double k : {1e-9, 1e3})
    add(std::string("curvatures of a saddle of ") + (k < 1 ? "1e-9" : "1e3") + " per metre", k, 1e-9, "",
        [k] { return curvatureCase(k, 0.3 / std::max(k, 1.0), 0.2 / std::max(k, 1.0)); });
}

}  // namespace glint::stability
