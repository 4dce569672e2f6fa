// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "tests/stability/scene.h"

namespace glint::stability {

/// The walks of method.md section 6 on k (x^2 [+ y^2] + z^2) + 2 z = 0, from doubles taken exactly.
template <class T>
struct RealWalk {
  T k;
  bool round;
  Vec<T> origin, normal;  ///< P_B and its normal, which span T
  RealCamera<T> camera;
  Vec<T> eye;
  Lamp<T> lamp;

  Vec<T> gradient(const Vec<T>& p) const { return {k * p.x, round ? T(k * p.y) : T(0), k * p.z + 1}; }
  /// Foot of origin + s d along the normal: the root of the quadratic that vanishes with its constant.
  Vec<T> foot(const T& s, const Vec<T>& d) const {
    using std::sqrt;
    const Vec<T> o = origin + s * d;
    const Vec<T> an{k * normal.x, round ? T(k * normal.y) : T(0), k * normal.z}, g = gradient(o);
    const T a = dot(normal, an), b = dot(g, normal), c = dot(o, g) + o.z;
    const T disc = b * b - a * c;
    const T t = -c / (b + (b > 0 ? T(1) : T(-1)) * sqrt(disc));
    return o + t * normal;
  }
  T alphaOnPlane(const T& s, const Vec<T>& d) const {
    const Vec<T> p = origin + s * d;
    return halfAngle(normal, lamp.from(p), eye - p);
  }
  T alphaOnSurface(const Vec<T>& p) const { return halfAngle(gradient(p), lamp.from(p), eye - p); }

  /// First reach at which f rises through 0, from a first guess.
  template <class F>
  T reach(const F& f, double first) const {
    T low = 0, high = T(first);
    for (int i = 0; i < 200 && f(high) < 0; ++i) {
      low = high;
      high *= T(1.3);
    }
    return rootBetween<T>(f, low, high);
  }
  T reachOnPlane(const Vec<T>& d, const T& limit, double first) const {
    return reach([&](const T& s) { return T(alphaOnPlane(s, d) - limit); }, first);
  }
  T reachOnSurface(const Vec<T>& d, const T& limit, double first) const {
    return reach([&](const T& s) { return T(alphaOnSurface(foot(s, d)) - limit); }, first);
  }
  /// Where the foot's pixel leaves a convex polygon, given counter-clockwise in its own coordinates.
  T reachPolygon(const Vec<T>& d, const std::vector<Pixel>& polygon, double first) const {
    const auto outside = [&](const T& s) {
      const auto [x, y] = camera.pixel(foot(s, d));
      T most = T(-1e30);
      for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Pixel &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
        const T ex = T(q.x()) - T(p.x()), ey = T(q.y()) - T(p.y());
        const T side = (x - T(p.x())) * ey - (y - T(p.y())) * ex;
        if (side > most) most = side;
      }
      return most;
    };
    return reach(outside, first);
  }
};

}  // namespace glint::stability
