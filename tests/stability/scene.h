// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <numbers>
#include <optional>
#include <vector>

#include "core/geometry/camera.h"
#include "core/geometry/light.h"
#include "core/surface/analytic.h"
#include "tests/stability/real.h"

/// Scenes whose contours are known in closed form but for one root: surfaces given by arc length from the origin, where their
/// tangent plane is z = 0.
namespace glint::stability {

/// Towards the light of most cases: off every axis.
inline Eigen::Vector3d obliqueDirection() { return Eigen::Vector3d(0.3, -0.2, 1).normalized(); }
/// A light 2 m away at so many degrees from the normal at the origin.
inline Light grazingLight(double degrees) {
  const double a = degrees * std::numbers::pi / 180;
  return Light::at(2 * Eigen::Vector3d(std::sin(a), 0, std::cos(a)));
}

/// Sheet (bent about y) or sphere of curvature k, 0 = plane; k > 0 is convex seen from +z.
template <class T>
struct Bent {
  T k;
  bool round;  ///< sphere
  Vec<T> along(const T& u, const T& v, bool normal) const {
    using std::cos;
    using std::sin;
    using std::sqrt;
    const T s = round ? T(sqrt(u * u + v * v)) : u;
    if (k == 0 || s == 0) return normal ? Vec<T>{T(0), T(0), T(1)} : Vec<T>{u, v, T(0)};
    const T angle = k * s, half = sin(angle / 2), cu = round ? T(u / s) : T(1), cv = round ? T(v / s) : T(0);
    if (normal) return {sin(angle) * cu, sin(angle) * cv, cos(angle)};
    const T reach = sin(angle) / k;
    return {reach * cu, round ? T(reach * cv) : v, -2 * half * half / k};
  }
  Vec<T> point(const T& u, const T& v) const { return along(u, v, false); }
  Vec<T> normal(const T& u, const T& v) const { return along(u, v, true); }
};

/// The same surface for the code under test: a sheet, or the sphere as the quadric k |x|^2 + 2 z = 0, whose centre may be far.
inline AnalyticSpec specOf(double k, bool round) {
  AnalyticSpec s;
  if (k == 0) {
    s.type = "plane";
  } else if (round) {
    s.type = "quadric";
    s.matrix.diagonal() << k, k, k, 0;
    s.matrix(2, 3) = s.matrix(3, 2) = 1;
  } else {
    s.type = "sheet";
    s.curvature = k;
  }
  return s;
}

/// A camera at `eye` that looks at `target`; the reference takes its doubles as they are.
inline Camera cameraTowards(const Eigen::Vector3d& eye, const Eigen::Vector3d& target, double focal, double skew = 0) {
  Camera c;
  c.pixelFromRay << focal, skew, 319.5, 0, focal, 239.5, 0, 0, 1;
  const Eigen::Vector3d z = (target - eye).normalized();
  Eigen::Vector3d x = z.cross(Eigen::Vector3d(0.2, 1, 0.1)).normalized();
  Eigen::Matrix3d r;
  r << x.transpose(), z.cross(x).transpose(), z.transpose();
  c.camFromWorld.linear() = r;
  c.camFromWorld.translation() = -(r * eye);
  c.width = 640;
  c.height = 480;
  return c;
}

/// One camera above the surface, with its exact centre.
template <class T>
struct RealView {
  Camera camera;
  RealCamera<T> real;
  Vec<T> eye;
  T u0, v0;  ///< surface parameters of (nearly) the mirror point
  RealView(const Camera& c, const T& u, const T& v) : camera(c), real(c), eye(real.eye()), u0(u), v0(v) {}
};

template <class T>
Lamp<T> lampOf(const Light& light) {
  return {exactly<T>(light.homogeneous().template head<3>()), T(light.homogeneous().w())};
}

template <class T>
T alphaAt(const Bent<T>& s, const Lamp<T>& lamp, const Vec<T>& eye, const T& u, const T& v) {
  const Vec<T> p = s.point(u, v);
  return halfAngle(s.normal(u, v), lamp.from(p), eye - p);
}

/// A view whose mirror point is the surface point (u, v): the eye stands on the reflected ray, `distance` away.
template <class T>
RealView<T> mirrorView(const Bent<T>& s, const Lamp<T>& lamp, double u, double v, double distance, double focal,
                       double skew = 0) {
  const Vec<T> p = s.point(T(u), T(v)), n = s.normal(T(u), T(v)), l = lamp.from(p);
  const Vec<T> r = T(2 * dot(n, l)) * n - l;
  return {cameraTowards(rounded(p + T(distance) * r), rounded(p), focal, skew), T(u), T(v)};
}

/// Surface parameters on the curve alpha = limit, in the direction `azimuth` of the parameters from (u, v).
template <class T>
std::pair<T, T> limitPoint(const Bent<T>& s, const Lamp<T>& lamp, const Vec<T>& eye, const T& u, const T& v, double azimuth,
                           const T& limit, double first) {
  const T c = T(std::cos(azimuth)), d = T(std::sin(azimuth));
  const auto f = [&](const T& reach) { return T(alphaAt(s, lamp, eye, T(u + reach * c), T(v + reach * d)) - limit); };
  T low = 0, high = T(first);
  while (f(high) < 0) {
    low = high;
    high *= T(1.4);
  }
  const T reach = rootBetween<T>(f, low, high);
  return {u + reach * c, v + reach * d};
}

/// The exact contour alpha = limit as pixels, each rounded once.
template <class T>
std::vector<Pixel> exactContour(const Bent<T>& s, const Lamp<T>& lamp, const RealView<T>& view, const T& limit, int n,
                                double first) {
  std::vector<Pixel> contour;
  for (int i = 0; i < n; ++i) {
    const auto [u, v] = limitPoint(s, lamp, view.eye, view.u0, view.v0, 2 * std::numbers::pi * i / n, limit, first);
    const auto [x, y] = view.real.pixel(s.point(u, v));
    contour.emplace_back(static_cast<double>(x), static_cast<double>(y));
  }
  return contour;
}

}  // namespace glint::stability
