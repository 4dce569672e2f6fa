// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/reflectance/lobe.h"
#include "tests/stability/scene.h"

/// Radiance of a lobe on a bent surface in exact numbers, from the textbook forms.
namespace glint::stability {

/// log of the radiance of a lobe; terms that cancel in differences along the surface stay out.
template <class T>
T logOfLobe(Lobe lobe, const T& m, const Vec<T>& n, const Vec<T>& l, const Vec<T>& v) {
  const Vec<T> h = unit(l + v);
  const T c = dot(n, h), tan2 = (1 - c * c) / (c * c);
  if (lobe == Lobe::BlinnPhong) return 2 / (m * m) * log(c);
  if (lobe == Lobe::Phong) return 1 / (2 * m * m) * log(T(2 * dot(n, l) * dot(n, v) - dot(l, v)));
  const auto tangent = [&](const Vec<T>& d) { return T(sqrt(T(1 - dot(n, d) * dot(n, d))) / dot(n, d)); };
  const auto lambda = [&](const Vec<T>& d) -> T {
    const T t = tangent(d);
    if (t <= 0) return 0;
    if (lobe == Lobe::Ggx) return (sqrt(T(1 + m * m * t * t)) - 1) / 2;
    const T a = 1 / (m * t);
    using std::atan;  // of exact numbers where T is one
    using std::erfc;
    const T pi = 4 * atan(T(1));
    return exp(T(-a * a)) / (2 * a * sqrt(pi)) - erfc(a) / 2;
  };
  const T d = lobe == Lobe::Ggx ? T(-2 * log(T(m * m + tan2))) : T(-tan2 / (m * m));
  return d - 4 * log(c) - log(T(1 + lambda(l) + lambda(v))) - log(dot(n, v));
}

/// A surface, a lamp and the radiance on it.
template <class T>
struct Lit {
  Bent<T> surface;
  Lamp<T> lamp;
  Lobe lobe;
  T m;
  T at(const Vec<T>& p, const Vec<T>& n, const Vec<T>& eye) const {
    const Vec<T> to = lamp.l - lamp.w * p;
    return logOfLobe<T>(lobe, m, n, unit(to), unit(eye - p)) - log(dot(to, to));
  }
  T at(const T& u, const T& v, const Vec<T>& eye) const { return at(surface.point(u, v), surface.normal(u, v), eye); }

  /// The maximum near (u, v), by Newton's method on differences far smaller than the scene; they keep half of the digits.
  std::pair<T, T> peak(T u, T v, const Vec<T>& eye, const T& size) const {
    const T h = size * T("1e-14");
    for (int i = 0; i < 60; ++i) {
      T f[3][3];
      for (int a = -1; a <= 1; ++a)
        for (int b = -1; b <= 1; ++b) f[a + 1][b + 1] = at(T(u + a * h), T(v + b * h), eye);
      const T gu = (f[2][1] - f[0][1]) / (2 * h), gv = (f[1][2] - f[1][0]) / (2 * h);
      const T uu = (f[2][1] - 2 * f[1][1] + f[0][1]) / (h * h), vv = (f[1][2] - 2 * f[1][1] + f[1][0]) / (h * h);
      const T uv = (f[2][2] - f[2][0] - f[0][2] + f[0][0]) / (4 * h * h), det = uu * vv - uv * uv;
      T du = -(vv * gu - uv * gv) / det, dv = -(uu * gv - uv * gu) / det;
      // Not yet where the field is concave: uphill by a tenth of the size.
      const T slope = sqrt(T(gu * gu + gv * gv));
      if (!(uu < 0 && det > 0)) du = size * gu / (10 * slope), dv = size * gv / (10 * slope);
      T share = 1;
      while (share > T("1e-6") && at(T(u + share * du), T(v + share * dv), eye) < f[1][1]) share /= 2;
      u += share * du;
      v += share * dv;
      if (sqrt(T(du * du + dv * dv)) < size * T("1e-20")) break;
    }
    return {u, v};
  }

  /// At the first hit of a pixel's ray on k |x|^2 + 2 z = 0 (sheet: without y): the root of the quadratic nearer to the eye.
  T atPixel(const Pixel& q, const RealView<T>& view) const {
    const Vec<T> o = view.eye, d = view.real.ray(T(q.x()), T(q.y()));
    const auto flat = [&](const Vec<T>& x) {
      return Vec<T>{surface.k * x.x, surface.round ? T(surface.k * x.y) : T(0), surface.k * x.z};
    };
    const Vec<T> ad = flat(d), ao = flat(o);
    const T a = dot(d, ad), b = dot(ao, d) + d.z, c = dot(o, ao) + 2 * o.z;
    const T root = b + (b > 0 ? 1 : -1) * sqrt(T(b * b - a * c));
    T t = -c / root;
    if (a != 0 && -root / a > 0 && (-root / a < t || t <= 0)) t = -root / a;
    const Vec<T> x = o + t * d, outward = flat(x);
    return at(x, unit(Vec<T>{outward.x, outward.y, outward.z + 1}), o);
  }
};

}  // namespace glint::stability
