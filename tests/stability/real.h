// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <limits>
#include <utility>

#include "core/geometry/camera.h"

/// Small vector algebra over any real type, for references of higher precision: T is a type of fifty decimal digits or long
/// double. Nothing here shares code with what it checks, and every double enters exactly.
namespace glint::stability {

template <class T>
struct Vec {
  T x{}, y{}, z{};
};
template <class T>
Vec<T> operator+(const Vec<T>& a, const Vec<T>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class T>
Vec<T> operator-(const Vec<T>& a, const Vec<T>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class T>
Vec<T> operator*(const T& s, const Vec<T>& a) {
  return {s * a.x, s * a.y, s * a.z};
}
template <class T>
T dot(const Vec<T>& a, const Vec<T>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class T>
Vec<T> cross(const Vec<T>& a, const Vec<T>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class T>
T length(const Vec<T>& a) {
  using std::sqrt;
  return sqrt(dot(a, a));
}
template <class T>
Vec<T> unit(const Vec<T>& a) {
  return T(1 / length(a)) * a;
}

template <class T>
Vec<T> exactly(const Eigen::Vector3d& v) {
  return {T(v.x()), T(v.y()), T(v.z())};
}
template <class T>
Eigen::Vector3d rounded(const Vec<T>& v) {
  return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
}
/// |value - reference| of a double vector against an exact one.
template <class T>
double apart(const Eigen::Vector3d& value, const Vec<T>& reference) {
  return static_cast<double>(length(exactly<T>(value) - reference));
}

/// A light in homogeneous coordinates.
template <class T>
struct Lamp {
  Vec<T> l;
  T w;
  Vec<T> from(const Vec<T>& p) const { return unit(l - w * p); }
};

/// Angle between N and H by the half-angle formula 2 asin(|a - b| / 2) of unit vectors, which keeps its digits near 0 and is not
/// the atan2 of the code under test.
template <class T>
T halfAngle(const Vec<T>& normal, const Vec<T>& toLight, const Vec<T>& toCamera) {
  using std::asin;
  const Vec<T> n = unit(normal), h = unit(unit(toLight) + unit(toCamera));
  return 2 * asin(length(n - h) / 2);
}

/// Solution of m x = b by Cramer's rule: exact enough at this precision.
template <class T>
Vec<T> solve3(const Vec<T>& r0, const Vec<T>& r1, const Vec<T>& r2, const Vec<T>& b) {
  const T d = dot(r0, cross(r1, r2));
  const Vec<T> c0 = cross(r1, r2), c1 = cross(r2, r0), c2 = cross(r0, r1);
  return T(1 / d) * (b.x * c0 + b.y * c1 + b.z * c2);
}

/// The camera as its doubles say it, including a rotation that is orthonormal to round-off only.
template <class T>
struct RealCamera {
  Vec<T> k[3], r[3], t;
  explicit RealCamera(const Camera& c) {
    for (int i = 0; i < 3; ++i) {
      k[i] = exactly<T>(c.pixelFromRay.row(i).transpose());
      r[i] = exactly<T>(c.camFromWorld.linear().row(i).transpose());
    }
    t = exactly<T>(c.camFromWorld.translation());
  }
  Vec<T> inCamera(const Vec<T>& p) const { return Vec<T>{dot(r[0], p), dot(r[1], p), dot(r[2], p)} + t; }
  Vec<T> eye() const { return solve3(r[0], r[1], r[2], T(-1) * t); }
  /// Homogeneous pixel.
  Vec<T> homogeneous(const Vec<T>& p) const {
    const Vec<T> q = inCamera(p);
    return {dot(k[0], q), dot(k[1], q), dot(k[2], q)};
  }
  std::pair<T, T> pixel(const Vec<T>& p) const {
    const Vec<T> h = homogeneous(p);
    return {h.x / h.z, h.y / h.z};
  }
  /// World direction of a pixel's ray, unit.
  Vec<T> ray(const T& x, const T& y) const {
    const Vec<T> q = solve3(k[0], k[1], k[2], Vec<T>{x, y, T(1)});
    return unit(solve3(r[0], r[1], r[2], q));
  }
};

/// Root of an increasing or decreasing f between a and b (opposite signs): Illinois steps, bisection when they are slow, until
/// the bracket is a few units of T's round-off.
template <class T, class F>
T rootBetween(const F& f, T a, T b) {
  using std::abs;
  T fa = f(a), fb = f(b);
  if (fa == 0) return a;
  if (fb == 0) return b;
  const T tolerance = 8 * std::numeric_limits<T>::epsilon();
  int side = 0;
  for (int i = 0; i < 400; ++i) {
    T x = i % 4 == 3 ? T((a + b) / 2) : T((a * fb - b * fa) / (fb - fa));
    const T fx = f(x);
    if (fx == 0) return x;
    if ((fx > 0) == (fb > 0)) {
      b = x;
      fb = fx;
      if (side == 1) fa /= 2;
      side = 1;
    } else {
      a = x;
      fa = fx;
      if (side == -1) fb /= 2;
      side = -1;
    }
    if (abs(b - a) <= tolerance * (abs(a) + abs(b))) break;
  }
  return (a + b) / 2;
}

}  // namespace glint::stability
