// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <unordered_map>

#include "core/geometry/plane.h"
#include "core/surface/point_surface.h"

namespace glint {
namespace {
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::Vector3i;

double crossOf(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

struct Inverted {
  Vector2d at;  ///< q / |q|^2
  int index;
};

/// Corners of the convex hull, counter-clockwise (Andrew's monotone chain).
std::vector<Inverted> hullOf(std::vector<Inverted> points) {
  std::sort(points.begin(), points.end(),
            [](const Inverted& a, const Inverted& b) { return std::pair(a.at.x(), a.at.y()) < std::pair(b.at.x(), b.at.y()); });
  std::vector<Inverted> hull(2 * points.size());
  std::size_t n = 0;
  const auto add = [&](const Inverted& p, std::size_t start) {
    while (n >= start + 2 && crossOf(hull[n - 1].at - hull[n - 2].at, p.at - hull[n - 1].at) <= 0) --n;
    hull[n++] = p;
  };
  for (const Inverted& p : points) add(p, 0);
  const std::size_t lower = n - 1;
  for (std::size_t i = points.size() - 1; i-- > 0;) add(points[i], lower);
  hull.resize(n - 1);
  return hull;
}

double circumradius(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  const double area2 = (b - a).cross(c - a).norm();
  return area2 > 0 ? (b - a).norm() * (c - b).norm() * (a - c).norm() / (2 * area2) : std::numeric_limits<double>::infinity();
}

/// The triangles around one point: pairs of consecutive neighbours.
void addStar(int centre, const std::vector<Vector3d>& points, const Vector3d& normal, const std::vector<int>& neighbours,
             double largest, std::vector<std::array<int, 3>>& found) {
  const Eigen::Matrix<double, 3, 2> axes = tangentBasis(normal);
  std::vector<Inverted> inverted;
  for (const int j : neighbours) {
    const Vector3d d = points[std::size_t(j)] - points[std::size_t(centre)];
    const Vector2d q = axes.transpose() * d;
    const double squared = q.squaredNorm();
    // Steeper than 60 degrees above the tangent plane: another sheet.
    constexpr double kFlat = 0.25;  // cos^2 of 60 degrees
    if (squared > kFlat * d.squaredNorm()) inverted.push_back({q / squared, j});
  }
  if (inverted.size() < 2) return;
  const std::vector<Inverted> hull = hullOf(std::move(inverted));
  for (std::size_t k = 0; k < hull.size() && hull.size() > 1; ++k) {
    const Inverted &a = hull[k], &b = hull[(k + 1) % hull.size()];
    if (!(crossOf(a.at, b.at) > 0)) continue;  // an edge that turns its back on the point: the border
    const auto at = [&](int i) { return points[std::size_t(i)]; };
    if (!(circumradius(at(centre), at(a.index), at(b.index)) <= largest)) continue;
    std::array<int, 3> t{centre, a.index, b.index};
    std::sort(t.begin(), t.end());
    found.push_back(t);
  }
}

struct Candidate {
  std::array<int, 3> corners;
  int stars = 0;
  double radius = 0;
};

/// The edges that have triangles, each with the third corners.
class Joined {
 public:
  Joined(const std::vector<Vector3d>& points, const std::vector<Vector3d>& normals) : points_(points), normals_(normals) {}

  bool add(const std::array<int, 3>& t) {
    for (int k = 0; k < 3; ++k)
      if (!hasRoom(t[std::size_t(k)], t[std::size_t((k + 1) % 3)], t[std::size_t((k + 2) % 3)])) return false;
    for (int k = 0; k < 3; ++k) {
      Edge& edge = edges_[keyOf(t[std::size_t(k)], t[std::size_t((k + 1) % 3)])];
      edge.third[std::size_t(edge.count++)] = t[std::size_t((k + 2) % 3)];
    }
    return true;
  }

 private:
  struct Edge {
    std::array<int, 2> third{};
    int count = 0;
  };
  static std::uint64_t keyOf(int a, int b) {
    return static_cast<std::uint64_t>(std::min(a, b)) << 32 | static_cast<std::uint32_t>(std::max(a, b));
  }
  /// At most two triangles, on its two sides.
  bool hasRoom(int a, int b, int third) const {
    const auto found = edges_.find(keyOf(a, b));
    if (found == edges_.end()) return true;
    if (found->second.count > 1) return false;
    const auto at = [&](int i) { return points_[std::size_t(i)]; };
    const Vector3d side = (at(b) - at(a)).cross(normals_[std::size_t(a)]);
    return side.dot(at(third) - at(a)) * side.dot(at(found->second.third[0]) - at(a)) < 0;
  }

  const std::vector<Vector3d>&points_, &normals_;
  std::unordered_map<std::uint64_t, Edge> edges_;
};

}  // namespace

std::vector<Vector3i> trianglesBetween(const std::vector<Vector3d>& points, const std::vector<Vector3d>& normals,
                                       const std::vector<std::vector<int>>& neighbours, const std::vector<double>& largest) {
  std::vector<std::array<int, 3>> found;
  for (std::size_t i = 0; i < points.size(); ++i)
    addStar(static_cast<int>(i), points, normals[i], neighbours[i], largest[i], found);
  std::sort(found.begin(), found.end());
  std::vector<Candidate> candidates;
  for (std::size_t i = 0; i < found.size();) {
    std::size_t end = i;
    while (end < found.size() && found[end] == found[i]) ++end;
    const auto& [a, b, c] = found[i];
    candidates.push_back({found[i], static_cast<int>(end - i),
                          circumradius(points[std::size_t(a)], points[std::size_t(b)], points[std::size_t(c)])});
    i = end;
  }
  std::stable_sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    return std::pair(-a.stars, a.radius) < std::pair(-b.stars, b.radius);
  });
  Joined joined(points, normals);
  std::vector<Vector3i> triangles;
  for (const Candidate& c : candidates)
    if (joined.add(c.corners)) triangles.emplace_back(c.corners[0], c.corners[1], c.corners[2]);
  return triangles;
}

}  // namespace glint
