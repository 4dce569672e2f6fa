// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Geometry>
#include <array>
#include <cstdint>

#include "io/mesh_builder.h"

namespace glint::io {
namespace {

using Eigen::Vector2d, Eigen::Vector3d, Eigen::Vector3i;

double cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

/// A polygon seen along the normal of its area, counter-clockwise: a warped one is cut as its picture is.
class Outline {
 public:
  Outline(const std::vector<Vector3d>& vertices, const std::vector<int>& corners) : points_(corners.size()) {
    const Vector3d& origin = vertices[std::size_t(corners.front())];
    const auto at = [&](std::size_t i) -> Vector3d { return vertices[std::size_t(corners[i])] - origin; };
    Vector3d area(0, 0, 0);
    for (std::size_t i = 1; i + 1 < corners.size(); ++i) area += at(i).cross(at(i + 1));
    area_ = area.norm();
    if (!(area_ > 0)) return;
    const Vector3d z = area / area_, x = z.unitOrthogonal(), y = z.cross(x);
    for (std::size_t i = 0; i < points_.size(); ++i) points_[i] = {x.dot(at(i)), y.dot(at(i))};
  }

  /// No triangle of the fan around the first corner lies beyond the outline. What has no area has no other cut.
  bool fanIsInside() const {
    constexpr double kRounding = 1e-6;  // share of the area: corners on a line, in single precision
    for (std::size_t i = 1; i + 1 < points_.size(); ++i)
      if (turn(0, i, i + 1) < -kRounding * area_) return false;
    return true;
  }

  /// Cuts off ears: corners whose neighbours see each other. @param tests  counts the points that are compared with triangles
  std::vector<Vector3i> cut(std::uint64_t& tests, std::uint64_t mostTests) {
    const std::size_t n = points_.size();
    next_.resize(n);
    before_.resize(n);
    for (std::size_t i = 0; i < n; ++i) next_[i] = (i + 1) % n, before_[i] = (i + n - 1) % n;
    std::vector<Vector3i> triangles;
    std::size_t at = 0, passed = 0;
    for (std::size_t left = n; left > 3;) {
      if (tests > mostTests) return {};
      // An outline that crosses itself may have no ear: any corner goes, so that the others are still cut.
      if (passed < left && !isEar(at, tests)) {
        at = next_[at];
        ++passed;
        continue;
      }
      triangles.push_back(Vector3i(int(before_[at]), int(at), int(next_[at])));
      next_[before_[at]] = next_[at];
      before_[next_[at]] = before_[at];
      at = next_[next_[at]];  // the next ear is one away, which makes fewer long ones
      passed = 0;
      --left;
    }
    triangles.push_back(Vector3i(int(before_[at]), int(at), int(next_[at])));
    return triangles;
  }

 private:
  double turn(std::size_t a, std::size_t b, std::size_t c) const {
    return cross(points_[b] - points_[a], points_[c] - points_[a]);
  }

  bool isEar(std::size_t at, std::uint64_t& tests) const {
    const std::size_t a = before_[at], c = next_[at];
    ++tests;
    if (!(turn(a, at, c) > 0)) return false;
    for (std::size_t p = next_[c]; p != a; p = next_[p]) {
      ++tests;
      // A slit to a hole passes the same places twice: they do not cover their own.
      if (points_[p] == points_[a] || points_[p] == points_[at] || points_[p] == points_[c]) continue;
      if (turn(a, at, p) >= 0 && turn(at, c, p) >= 0 && turn(c, a, p) >= 0) return false;
    }
    return true;
  }

  std::vector<Vector2d> points_;
  std::vector<std::size_t> next_, before_;  ///< the ring of corners that are left
  double area_ = 0;
};

/// The corners of a polygon that is a fan of triangles, as places in `triangles`.
std::vector<int> cornersOfFan(const std::vector<Vector3i>& triangles, std::size_t first, std::size_t count) {
  std::vector<int> corners{triangles[first].x(), triangles[first].y()};
  for (std::size_t i = 0; i < count; ++i) corners.push_back(triangles[first + i].z());
  return corners;
}

}  // namespace

void Fan::cut(const std::vector<Vector3d>& vertices, std::vector<Vector3i>& beside, const std::string& file) const {
  constexpr std::uint64_t kMostTests = 1'000'000'000;  // of points with triangles: some 3 s
  std::uint64_t tests = 0;
  for (const Polygon& p : polygons_) {
    const std::vector<int> corners = cornersOfFan(triangles_, p.first, p.triangles);
    Outline outline(vertices, corners);
    if (outline.fanIsInside()) continue;
    const std::vector<Vector3i> cut = outline.cut(tests, kMostTests);
    if (cut.empty())
      fail(file, "",
           "its concave polygons are too large, here of " + std::to_string(corners.size()) +
               " corners: cut the mesh into triangles");
    const std::vector<int> others = beside.empty() ? std::vector<int>() : cornersOfFan(beside, p.first, p.triangles);
    for (std::size_t i = 0; i < cut.size(); ++i)
      for (int k = 0; k < 3; ++k) {
        triangles_[p.first + i][k] = corners[std::size_t(cut[i][k])];
        if (!others.empty()) beside[p.first + i][k] = others[std::size_t(cut[i][k])];
      }
  }
}

}  // namespace glint::io
