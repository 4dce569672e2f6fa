// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cstdio>

#include "core/light/estimate.h"
#include "core/light/refine_depth.h"
#include "tests/stability/cases.h"
#include "tests/stability/fifty_digits.h"
#include "tests/stability/scene.h"

namespace glint::stability {
namespace {

/// min sum |(I - r r^T)(L - P)|^2 by its normal equations, which fifty digits can bear.
Vec<Real> closestPoint(const std::vector<ReflectedRay>& rays) {
  Vec<Real> m[3] = {}, b{};
  for (const ReflectedRay& ray : rays) {
    const Vec<Real> p = exactly<Real>(ray.origin), r = unit(exactly<Real>(ray.direction));
    const Vec<Real> across = p - dot(r, p) * r;
    b = b + across;
    m[0] = m[0] + Vec<Real>{1 - r.x * r.x, -r.x * r.y, -r.x * r.z};
    m[1] = m[1] + Vec<Real>{-r.y * r.x, 1 - r.y * r.y, -r.y * r.z};
    m[2] = m[2] + Vec<Real>{-r.z * r.x, -r.z * r.y, 1 - r.z * r.z};
  }
  return solve3(m[0], m[1], m[2], b);
}

/// Rays from points spread over `base` around the origin to a light, each off by `noise` radians.
std::vector<ReflectedRay> raysTo(const Eigen::Vector3d& light, double base, int n, double noise) {
  std::vector<ReflectedRay> rays;
  for (int i = 0; i < n; ++i) {
    const Eigen::Vector3d p = base * Eigen::Vector3d(std::cos(2.4 * i), std::sin(2.4 * i), 0.2 * std::sin(7.0 * i));
    const Eigen::Vector3d off(std::sin(3.0 * i), std::cos(5.0 * i), std::sin(11.0 * i));
    rays.push_back({p, ((light - p).normalized() + noise * off).normalized(), Eigen::Vector3d::UnitZ()});
  }
  return rays;
}

/// Error over the distance of the light from the rays' origins.
Outcome<Measured> triangulationCase(const std::vector<ReflectedRay>& rays, double minCondition = 1e-8) {
  const Outcome<Triangulation> t = triangulateLight(rays, minCondition);
  if (!t) return t.failure();
  if (t->light.atInfinity()) return Failure{Reason::ParallelRays, "the answer is a direction"};
  const Vec<Real> reference = closestPoint(rays);
  return Measured{apart(t->light.position(), reference) / static_cast<double>(length(reference - exactly<Real>(rays[0].origin))),
                  1 / std::sqrt(t->condition)};
}

/// Error of a light seen from the origin: both as points of the unit sphere of (l, w) with `unit` metres as the unit of length.
/// Finite and infinite lights are measured alike: to a prediction the light is a direction and a small parallax.
double lightError(const Light& a, const Light& b, double unit) {
  Eigen::Vector4d x = a.homogeneous(), y = b.homogeneous();
  x.w() *= unit;
  y.w() *= unit;
  const Eigen::Matrix<long double, 4, 1> p = x.cast<long double>().normalized(), q = y.cast<long double>().normalized();
  return static_cast<double>((p - q).norm());
}

enum class Refine { Nothing, Poses, Depth, Extent };

struct BundleScene {
  double curvature = 0.8;
  bool round = true;
  double scale = 1, base = 0.15, distance = 1.5, focal = 800, limit = std::numbers::pi / 30;
  int views = 6, points = 36, distinct = 0;  ///< `distinct` > 0: views repeat
  bool oneCentre = false;
  Refine refine = Refine::Nothing;
};

/// The light and the limit angle with what is refined beside them. From exact contours of a point light there is nothing to
/// refine, so that the answer is the same; what moved all the same is an error.
struct Refined {
  Light light;
  double limit = 0, moved = 0;
};
Outcome<Refined> refined(const std::vector<BundleView>& views, const Light& start, const BundleOptions& options, Refine what) {
  if (what == Refine::Poses) {
    const Outcome<PoseRefinement> r = refinePoses(views, start, 0.3, options);
    if (!r) return r.failure();
    return Refined{r->bundle.light, r->bundle.limitAngle, r->movedPx};
  }
  if (what == Refine::Depth) {
    const Outcome<DepthRefinement> r = refineDepth(views, start, 0.005, options);
    if (!r) return r.failure();
    return Refined{r->light, r->limitAngle, r->correction.coefficients.norm()};
  }
  BundleOptions wide = options;
  if (what == Refine::Extent) wide.limitOrders = 1;
  const Outcome<Bundle> b = bundleLight(views, start, wide);
  if (!b) return b.failure();
  // As a squared angle: at infinity it is one already. A light at 1e9 m whose extent is 1e-8 rad wide has one of 100 m^2.
  const double distance = b->light.atInfinity() ? 1.0 : b->light.position().norm();
  const double extent = b->extent ? b->extent->norm() / (distance * distance) : 0;
  return Refined{b->light, b->limitAngle, extent};
}

/// Exact contours of one limit angle, each rounded to double once; the truth is the light they were made with.
template <class T>
Outcome<Measured> bundleCase(const BundleScene& b, const Light& light, double condition) {
  const Bent<T> s{T(b.curvature / b.scale), b.round};
  const Lamp<T> lamp = lampOf<T>(light);
  const T limit = T(b.limit);
  const auto surface = makeAnalytic(specOf(b.curvature / b.scale, b.round));
  std::vector<BundleView> views;
  std::vector<ReflectedRay> rays;
  for (int i = 0; i < b.views; ++i) {
    if (b.distinct > 0 && i >= b.distinct) {
      views.push_back(views[i % b.distinct]);
      rays.push_back(rays[i % b.distinct]);
      continue;
    }
    const double u = b.oneCentre ? 0 : b.base * b.scale * std::cos(2.4 * i),
                 v = b.oneCentre ? 0 : b.base * b.scale * std::sin(2.4 * i);
    RealView<T> view = mirrorView(s, lamp, u, v, b.distance * b.scale, b.focal);
    if (b.oneCentre)
      view = RealView<T>(cameraTowards(view.camera.centreInWorld(),
                                       0.03 * b.scale * Eigen::Vector3d(std::cos(2.4 * i), std::sin(2.4 * i), 0), b.focal),
                         T(u), T(v));
    BundleView bundle{view.camera, surface.get(), exactContour(s, lamp, view, limit, b.points, 0.02 * b.scale), {}};
    const auto [x, y] = view.real.pixel(s.point(view.u0, view.v0));
    const Outcome<BrightestPoint> peak =
        observedBrightestPoint(*surface, view.camera, Pixel(static_cast<double>(x), static_cast<double>(y)));
    if (!peak) return peak.failure();
    rays.push_back(reflectedRay(*peak, view.camera));
    bundle.brightest = *peak;
    views.push_back(std::move(bundle));
  }
  const Outcome<Triangulation> start = triangulateLight(rays);
  BundleOptions options;
  options.pointsPerView = b.points;
  const Outcome<Refined> found = refined(views, start ? start->light : Light::towards(rays[0].direction), options, b.refine);
  if (!found) return found.failure();
  const double limitError = std::abs(found->limit / b.limit - 1);
  return Measured{worstOf({lightError(found->light, light, b.scale), limitError, found->moved}), condition};
}

}  // namespace

void addLightCases(Cases& cases) {
  const auto add = [&](const char* stage, const std::string& name, double parameter, double tolerance, const char* note,
                       auto run) { cases.push_back(answerCase(stage, name, parameter, tolerance, note, run)); };
  const Eigen::Vector3d d = obliqueDirection();
  const char* const t = "triangulation";
  add(t, "light at 1e-2 m", 1e-2, 1e-9, "", [d] { return triangulationCase(raysTo(1e-2 * d, 0.01, 6, 1e-4)); });
  add(t, "scene scale 1e-6", 1e-6, 1e-9, "", [d] { return triangulationCase(raysTo(2e-6 * d, 3e-7, 6, 1e-4)); });
  add(t, "scene scale 1e6", 1e6, 1e-9, "", [d] { return triangulationCase(raysTo(2e6 * d, 3e5, 6, 1e-4)); });
  add(t, "2 views", 2, 1e-9, "", [d] { return triangulationCase(raysTo(2 * d, 0.3, 2, 1e-4)); });
  add(t, "1,000 views", 1000, 1e-9, "", [d] { return triangulationCase(raysTo(2 * d, 0.3, 1000, 1e-3)); });
  add(t, "3 views, each 50 times", 50, 1e-9, "", [d] {
    const std::vector<ReflectedRay> once = raysTo(2 * d, 0.3, 3, 1e-4);
    std::vector<ReflectedRay> many;
    for (int i = 0; i < 150; ++i) many.push_back(once[i % 3]);
    return triangulationCase(many);
  });
  // The parallax is 1e-9 rad and the directions are doubles: 2 units of round-off each over that parallax.
  add(t, "light at 1e9 m, rays 0.5 m apart, kept finite", 1e9, 64 * kRound * 2e9,
      "the directions' round-off over a parallax of 5e-10 rad", [d] { return triangulationCase(raysTo(1e9 * d, 0.5, 6, 0), 0); });
  add(t, "surface points 1e-6 m apart", 1e-6, 64 * kRound * 2e6, "the directions' round-off over a parallax of 5e-7 rad",
      [d] { return triangulationCase(raysTo(2 * d, 1e-6, 6, 0), 0); });
  {
    Case c;
    c.stage = t;
    c.name = "light at 1e9 m, as the pipeline asks";
    c.parameter = 1e9;
    c.note = "beyond a parallax of 1e-4 rad a direction is the answer: its error is the parallax itself";
    c.run = [d]() -> Outcome<Measured> {
      const std::vector<ReflectedRay> rays = raysTo(1e9 * d, 0.5, 6, 0);
      const Outcome<Triangulation> result = triangulateLight(rays);
      if (!result) return result.failure();
      return Measured{lightError(result->light, Light::at(1e9 * d), 1), 1e9};
    };
    c.tolerance = 2e-9;
    cases.push_back(c);
  }
  add(t, "light at infinity", 0, 1e-9, "", [d]() -> Outcome<Measured> {
    std::vector<ReflectedRay> rays = raysTo(2 * d, 0.5, 6, 0);
    for (ReflectedRay& r : rays) r.direction = d;
    const Outcome<Triangulation> result = triangulateLight(rays);
    if (!result) return result.failure();
    return Measured{lightError(result->light, Light::towards(d), 1)};
  });
  {
    Case c;
    c.stage = t;
    c.name = "parallel rays in opposite directions";
    c.note = "no direction fits both";
    c.expect = Expect::Failure;
    c.reasons = {Reason::ParallelRays};
    c.run = [d]() -> Outcome<Measured> {
      const Outcome<Triangulation> r =
          triangulateLight({{{0, 0, 0}, d, Eigen::Vector3d::UnitZ()}, {{1, 0, 0}, -d, -Eigen::Vector3d::UnitZ()}});
      if (!r) return r.failure();
      return Measured{0};
    };
    cases.push_back(c);
    c.name = "one ray";
    c.note = "one ray does not define a point";
    c.reasons = {Reason::TooFewViews};
    c.run = [d]() -> Outcome<Measured> {
      const Outcome<Triangulation> r = triangulateLight({{{0, 0, 0}, d, Eigen::Vector3d::UnitZ()}});
      if (!r) return r.failure();
      return Measured{0};
    };
    cases.push_back(c);
  }

  const char* const b = "bundle";
  const Light lamp = Light::at(2 * d);
  add(b, "light at 2 m (reference)", 2, 1e-9, "", [=] { return bundleCase<Real>({}, lamp, 1); });
  add(b, "light at 1e-2 m", 1e-2, 1e-9, "",
      [=] { return bundleCase<Real>({.base = 0.004, .distance = 0.3, .focal = 2000}, Light::at(1e-2 * d), 1); });
  add(b, "light at 1e9 m", 1e9, 1e-9, "as (l, w): direction and parallax per metre",
      [=] { return bundleCase<Real>({}, Light::at(1e9 * d), 1e9); });
  add(b, "light at infinity", 0, 1e-9, "", [=] { return bundleCase<Real>({}, Light::towards(d), 1); });
  add(b, "curvature 1e-9 per metre", 1e-9, 1e-9, "",
      [=] { return bundleCase<Real>({.curvature = 1e-9, .round = false}, lamp, 1); });
  add(b, "curvature 1e3 per metre", 1e3, 1e-9, "",
      [=] { return bundleCase<Real>({.curvature = 1e3, .base = 3e-4, .distance = 0.1, .focal = 5000}, lamp, 1); });
  add(b, "scene scale 1e-6", 1e-6, 1e-9, "", [=] { return bundleCase<Real>({.scale = 1e-6}, Light::at(2e-6 * d), 1); });
  add(b, "scene scale 1e6", 1e6, 1e-9, "", [=] { return bundleCase<Real>({.scale = 1e6}, Light::at(2e6 * d), 1); });
  add(b, "2 views", 2, 1e-9, "", [=] { return bundleCase<Real>({.views = 2}, lamp, 1); });
  add(b, "1,000 views", 1000, 1e-9, "", [=] { return bundleCase<long double>({.views = 1000, .points = 8}, lamp, 1); });
  add(b, "6 views, each 20 times", 20, 1e-9, "",
      [=] { return bundleCase<Real>({.views = 120, .points = 12, .distinct = 6}, lamp, 1); });
  add(b, "cameras 1e-6 m apart", 1e-6, 1e-9, "one contour already determines the light",
      [=] { return bundleCase<Real>({.base = 1e-6}, lamp, 1e6); });
  add(b, "all cameras in one centre", 0, 1e-9, "one contour already determines the light",
      [=] { return bundleCase<Real>({.oneCentre = true}, lamp, 1); });
  add(b, "focal length 50 px", 50, 1e-9, "", [=] { return bundleCase<Real>({.focal = 50}, lamp, 1); });
  add(b, "focal length 50,000 px", 5e4, 1e-9, "", [=] { return bundleCase<Real>({.focal = 5e4}, lamp, 1); });
  struct Refined {
    const char* stage;
    Refine what;
  };
  for (const Refined& r : {Refined{"bundle, poses refined", Refine::Poses}, Refined{"bundle, depth refined", Refine::Depth},
                           Refined{"bundle, extent of the light", Refine::Extent}}) {
    const char* const stage = r.stage;
    const Refine what = r.what;
    const char* const note = "exact contours of a point light: nothing to refine";
    add(stage, "light at 2 m", 2, 1e-9, note, [=] { return bundleCase<Real>({.refine = what}, lamp, 1); });
    add(stage, "scene scale 1e-6", 1e-6, 1e-9, note,
        [=] { return bundleCase<Real>({.scale = 1e-6, .refine = what}, Light::at(2e-6 * d), 1); });
    add(stage, "scene scale 1e6", 1e6, 1e-9, note,
        [=] { return bundleCase<Real>({.scale = 1e6, .refine = what}, Light::at(2e6 * d), 1); });
    add(stage, "light at 1e9 m", 1e9, 1e-9, note, [=] { return bundleCase<Real>({.refine = what}, Light::at(1e9 * d), 1e9); });
    add(stage, "light at infinity", 0, 1e-9, note, [=] { return bundleCase<Real>({.refine = what}, Light::towards(d), 1); });
    add(stage, "6 views, each 20 times", 20, 1e-9, note,
        [=] { return bundleCase<Real>({.views = 120, .points = 12, .distinct = 6, .refine = what}, lamp, 1); });
  }
  for (const double degrees : {80.0, 85.0}) {
    const double a = degrees * std::numbers::pi / 180;
    // No normal of a contour point is turned beyond the horizon: 0.9 degrees over the mirror points, 1.5 of the limit.
    const Light low = Light::at(2 * Eigen::Vector3d(std::sin(a), 0, std::cos(a)));
    add(b, "grazing " + std::string(degrees == 80 ? "80" : "85") + " degrees", degrees, 1e-9, "", [=] {
      return bundleCase<Real>({.curvature = 0.5, .base = 0.03, .limit = std::numbers::pi / 120}, low, 1 / std::cos(a));
    });
  }
}

}  // namespace glint::stability
