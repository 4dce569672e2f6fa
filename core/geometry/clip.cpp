// SPDX-License-Identifier: BSD-3-Clause
#include "core/geometry/clip.h"

#include <utility>

namespace glint {
namespace {

/// The part where sign * coordinate <= sign * bound.
std::vector<Pixel> cutAt(const std::vector<Pixel>& points, int axis, double bound, double sign) {
  std::vector<Pixel> kept;
  const auto inside = [&](const Pixel& p) { return sign * p[axis] <= sign * bound; };
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Pixel &a = points[i], &b = points[(i + 1) % points.size()];
    if (inside(a)) kept.push_back(a);
    if (inside(a) == inside(b)) continue;
    Pixel crossing = a + (bound - a[axis]) / (b[axis] - a[axis]) * (b - a);
    crossing[axis] = bound;
    kept.push_back(crossing);
  }
  return kept;
}

}  // namespace

Polyline clippedTo(const Eigen::AlignedBox2d& box, const Polyline& closed) {
  std::vector<Pixel> points = closed.points;
  for (const int axis : {0, 1})
    for (const auto& [bound, sign] : {std::pair(box.min()[axis], -1.0), std::pair(box.max()[axis], 1.0)})
      points = cutAt(points, axis, bound, sign);
  Polyline part{std::move(points), true};
  if (part.points.size() < 3) part.points.clear();
  return part;
}

}  // namespace glint
