// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cstdio>

#include "core/model/walk.h"
#include "tests/stability/cases.h"
#include "tests/stability/fifty_digits.h"
#include "tests/stability/real_walk.h"

namespace glint::stability {
namespace {

struct WalkScene {
  double curvature = 0.8;
  bool round = true;
  double scale = 1, distance = 1.5, focal = 800;
  double limit = 0.1;     ///< rad
  double contourPx = 20;  ///< radius of the contour
  double condition = 1;
};

/// All that a walk needs, and its exact twin.
struct WalkStage {
  std::shared_ptr<const Surface> surface;
  Camera camera;
  Light light;
  BrightestPoint brightest;
  RealWalk<Real> real;
};
WalkStage stageOf(const WalkScene& w, const Light& light) {
  const double k = w.curvature / w.scale;
  const Bent<Real> bent{Real(k), w.round};
  const double u = w.curvature > 10 ? 1e-4 : 0.05 * w.scale, v = 0.6 * u;
  const RealView<Real> view = mirrorView(bent, lampOf<Real>(light), u, v, w.distance * w.scale, w.focal);
  const Vec<Real> p = bent.point(view.u0, view.v0), n = bent.normal(view.u0, view.v0);
  const auto [x, y] = view.real.pixel(p);
  const SurfacePoint point{rounded(p), rounded(n).normalized()};
  return {
      makeAnalytic(specOf(k, w.round)),
      view.camera,
      light,
      {point, Pixel(static_cast<double>(x), static_cast<double>(y)), 0},
      {Real(k), w.round, exactly<Real>(point.position), exactly<Real>(point.normal), view.real, view.eye, lampOf<Real>(light)}};
}

/// Reaches of the limit on T and on S in 8 directions, each over its own length.
Outcome<Measured> reachCase(const WalkScene& w, const Light& light) {
  const WalkStage s = stageOf(w, light);
  WalkOptions options;
  options.toleranceRad = 1e-15;
  const TangentWalk walk(*s.surface, s.camera, s.brightest, s.light, options);
  double worst = 0;
  for (int i = 0; i < 8; ++i) {
    const Eigen::Vector3d d = walk.direction(0.3 + i * std::numbers::pi / 4);
    const double first = 5 * walk.metresPerPixel();
    const Outcome<double> onPlane = walk.reachOnPlane(d, w.limit, first);
    const Outcome<TangentWalk::Reach> onSurface = walk.reachOnSurface(d, w.limit, first);
    if (!onPlane) return onPlane.failure();
    if (!onSurface) return onSurface.failure();
    const Real a = s.real.reachOnPlane(exactly<Real>(d), Real(w.limit), first);
    const Real b = s.real.reachOnSurface(exactly<Real>(d), Real(w.limit), first);
    worst = worstOf({worst, static_cast<double>(abs(Real(*onPlane) / a - 1)),
                     static_cast<double>(abs(Real(onSurface->distance) / b - 1)),
                     apart(onSurface->point.position, s.real.foot(b, exactly<Real>(d))) / static_cast<double>(b)});
  }
  return Measured{worst, w.condition};
}

/// Canonical contour of a 24-gon around the peak: walk on S to the polygon, take alpha, walk on T to the same alpha.
Outcome<Measured> canonicalCase(const WalkScene& w, const Light& light) {
  const WalkStage s = stageOf(w, light);
  WalkOptions options;
  options.toleranceRad = 1e-15;
  const TangentWalk walk(*s.surface, s.camera, s.brightest, s.light, options);
  Polyline contour;
  for (int i = 0; i < 24; ++i) {
    const double t = 2 * std::numbers::pi * (i + 0.37) / 24;
    contour.points.push_back(s.brightest.pixel + w.contourPx * Pixel(std::cos(t), std::sin(t)));
  }
  const CanonicalContour c = canonicalContour(walk, s.camera, contour, 8);
  double worst = 0;
  for (const DirectionResult& r : c.directions) {
    if (r.failure) return *r.failure;
    const Vec<Real> d = exactly<Real>(walk.direction(r.azimuth));
    const double first = 2 * w.contourPx * walk.metresPerPixel();
    const Real onSurface = s.real.reachPolygon(d, contour.points, first);
    const Real alpha = s.real.alphaOnSurface(s.real.foot(onSurface, d));
    const Real onPlane = s.real.reachOnPlane(d, alpha, first);
    worst = worstOf({worst, static_cast<double>(abs(Real(*r.limitAngle) / alpha - 1)),
                     apart(r.onTangentPlane, s.real.origin + onPlane * d) / static_cast<double>(onPlane)});
  }
  return Measured{worst, w.condition};
}

}  // namespace

void addWalkCases(Cases& cases) {
  const Eigen::Vector3d d = obliqueDirection();
  struct Row {
    const char* name;
    double parameter;
    WalkScene scene;
    Light light;
    double tolerance = 1e-9;
    const char* note = "";
  };
  const Row rows[] = {
      {"light at 1e-2 m", 1e-2, {.distance = 0.3, .focal = 2000}, Light::at(Eigen::Vector3d(0.052, 0.028, 0.009))},
      {"light at 1e9 m", 1e9, {}, Light::at(1e9 * d)},
      {"light at infinity", 0, {}, Light::towards(d)},
      {"curvature 1e-9 per metre", 1e-9, {.curvature = 1e-9, .round = false}, Light::at(2 * d)},
      {"curvature 1e3 per metre", 1e3, {.curvature = 1e3, .distance = 0.1, .focal = 5e4}, Light::at(2 * d)},
      {"concave, curvature -0.3 per metre", -0.3, {.curvature = -0.3, .distance = 1}, Light::at(1 * d)},
      {"scene scale 1e-6", 1e-6, {.scale = 1e-6}, Light::at(2e-6 * d)},
      {"scene scale 1e6", 1e6, {.scale = 1e6}, Light::at(2e6 * d)},
      {"focal length 50 px", 50, {.focal = 50, .contourPx = 2}, Light::at(2 * d)},
      {"focal length 50,000 px", 5e4, {.focal = 5e4, .contourPx = 1000}, Light::at(2 * d)},
      {"grazing 85 degrees", 85, {.curvature = 0.5, .limit = 0.02, .contourPx = 3, .condition = 11.5}, grazingLight(85)},
      {"grazing 89 degrees", 89, {.curvature = 0.5, .limit = 4e-3, .contourPx = 0.3, .condition = 57}, grazingLight(89)},
      {"limit angle 1e-6 rad (highlight of 1e-3 px)",
       1e-6,
       {.limit = 1e-6, .contourPx = 1e-3, .condition = 1e6},
       Light::at(2 * d),
       16 * kRound * 1e6,
       "the surface point's own round-off over the walk's length"},
  };
  for (const Row& row : rows)
    for (const bool canonical : {false, true}) {
      Case c;
      c.stage = canonical ? "canonical contour" : "walk";
      c.name = row.name;
      c.parameter = row.parameter;
      c.tolerance = row.tolerance;
      c.note = row.note;
      const WalkScene scene = row.scene;
      const Light light = row.light;
      if (canonical)
        c.run = [scene, light] { return canonicalCase(scene, light); };
      else
        c.run = [scene, light] { return reachCase(scene, light); };
      cases.push_back(c);
    }
  Case c;
  c.stage = "walk";
  c.name = "limit beyond the horizon";
  c.parameter = 1.6;
  c.note = "no visible point has such an angle";
  c.expect = Expect::Failure;
  c.reasons = {Reason::NotReached, Reason::SurfaceEnded, Reason::Occluded, Reason::LightBehindSurface};
  c.run = [d] { return reachCase({.limit = 1.6}, Light::at(2 * d)); };
  cases.push_back(c);
}

}  // namespace glint::stability
