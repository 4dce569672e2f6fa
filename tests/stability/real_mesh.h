// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "core/surface/surface.h"
#include "tests/stability/real.h"

namespace glint::stability {

/// A triangle mesh in exact numbers, under the three normal policies of core/surface/mesh.h, from their definitions.
template <class T>
struct RealMesh {
  std::vector<Vec<T>> vertices, normals;  ///< normals of any length
  std::vector<Eigen::Vector3i> triangles;

  struct At {
    Vec<T> point, normal;  ///< normal: unit
  };
  /// The place of weights (1 - b - c, b, c) on a triangle; weights a little outside go on smoothly.
  At at(NormalPolicy policy, int element, const T& b, const T& c) const {
    const std::array<T, 3> w{T(1 - b - c), b, c};
    Vec<T> flat{}, normal{};
    for (int i = 0; i < 3; ++i) {
      flat = flat + w[i] * vertices[triangles[element][i]];
      normal = normal + w[i] * unit(normals[triangles[element][i]]);
    }
    if (policy == NormalPolicy::Facet) {
      const Vec<T>&p = vertices[triangles[element].x()], &q = vertices[triangles[element].y()],
            &r = vertices[triangles[element].z()];
      return {flat, unit(cross(q - p, r - p))};
    }
    if (policy == NormalPolicy::Interpolated) return {flat, unit(normal)};
    // Half of the way to the mean of the feet in the corners' tangent planes (Phong tessellation).
    Vec<T> feet{};
    for (int i = 0; i < 3; ++i) {
      const Vec<T> n = unit(normals[triangles[element][i]]);
      feet = feet + w[i] * (flat - dot(flat - vertices[triangles[element][i]], n) * n);
    }
    return {T(1) / 2 * (flat + feet), unit(normal)};
  }

  /// Where the ray o + s d meets the triangle near the weights (b, c): Newton's method by differences of half of the digits.
  At hitNear(NormalPolicy policy, int element, T b, T c, const Vec<T>& o, const Vec<T>& d) const {
    const T h("1e-24");
    for (int i = 0; i < 12; ++i) {
      const Vec<T> p = at(policy, element, b, c).point, pb = T(1 / h) * (at(policy, element, T(b + h), c).point - p),
                   pc = T(1 / h) * (at(policy, element, b, T(c + h)).point - p);
      // p + pb db + pc dc = o + s d: the components across d.
      const Vec<T> u = cross(d, Vec<T>{d.y, d.z, d.x}), v = cross(d, u), gap = o - p;
      const T a00 = dot(pb, u), a01 = dot(pc, u), a10 = dot(pb, v), a11 = dot(pc, v), g0 = dot(gap, u), g1 = dot(gap, v);
      const T det = a00 * a11 - a01 * a10;
      b += (a11 * g0 - a01 * g1) / det;
      c += (a00 * g1 - a10 * g0) / det;
    }
    return at(policy, element, b, c);
  }

  /// Where the half vector is along the normal, near the weights (b, c); the same method.
  At mirrorNear(NormalPolicy policy, int element, T b, T c, const Vec<T>& eye, const Lamp<T>& lamp) const {
    const auto tilt = [&](const T& x, const T& y) {
      const At s = at(policy, element, x, y);
      const Vec<T> half = lamp.from(s.point) + unit(eye - s.point);
      const Vec<T> u = cross(s.normal, Vec<T>{T(1), T(0), T(0)});
      return std::array<T, 2>{dot(half, u), dot(half, cross(s.normal, u))};
    };
    const T h("1e-24");
    for (int i = 0; i < 12; ++i) {
      const auto g = tilt(b, c), gb = tilt(T(b + h), c), gc = tilt(b, T(c + h));
      const T a00 = (gb[0] - g[0]) / h, a01 = (gc[0] - g[0]) / h, a10 = (gb[1] - g[1]) / h, a11 = (gc[1] - g[1]) / h;
      const T det = a00 * a11 - a01 * a10;
      b -= (a11 * g[0] - a01 * g[1]) / det;
      c -= (a00 * g[1] - a10 * g[0]) / det;
    }
    return at(policy, element, b, c);
  }
};

}  // namespace glint::stability
