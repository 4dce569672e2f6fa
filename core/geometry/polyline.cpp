// SPDX-License-Identifier: BSD-3-Clause
#include "core/geometry/polyline.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/base/outcome.h"

namespace glint {

namespace {
std::size_t segmentCount(const Polyline& line) {
  const std::size_t n = line.points.size();
  return n < 2 ? 0 : line.closed ? n : n - 1;
}
double cross(const Pixel& a, const Pixel& b) { return a.x() * b.y() - a.y() * b.x(); }
}  // namespace

double length(const Polyline& line) {
  double sum = 0;
  const std::size_t n = line.points.size();
  for (std::size_t i = 0; i < segmentCount(line); ++i) sum += (line.points[(i + 1) % n] - line.points[i]).norm();
  return sum;
}

double signedArea(const Polyline& line) {
  const auto& p = line.points;
  if (p.size() < 3) return 0;
  double twice = 0;  // relative to the first point, so that far-away shapes lose no digits
  for (std::size_t i = 1; i + 1 < p.size(); ++i) twice += cross(p[i] - p[0], p[i + 1] - p[0]);
  return 0.5 * twice;
}

Pixel centroid(const Polyline& line) {
  const auto& p = line.points;
  require(!p.empty(), "centroid: empty polyline");
  Pixel weighted(0, 0), mean(0, 0);
  double twice = 0;
  for (std::size_t i = 1; i + 1 < p.size(); ++i) {
    const double a = cross(p[i] - p[0], p[i + 1] - p[0]);
    weighted += a * ((p[i] - p[0]) + (p[i + 1] - p[0])) / 3;
    twice += a;
  }
  const double size = length(line);
  if (std::abs(twice) > 1e-12 * size * size) return p[0] + weighted / twice;  // thinner than that the area is round-off
  for (const Pixel& q : p) mean += q;
  return mean / double(p.size());
}

bool contains(const Polyline& line, const Pixel& q) {
  bool inside = false;
  const auto& p = line.points;
  for (std::size_t i = 0, j = p.size() - 1; i < p.size(); j = i++) {
    if ((p[i].y() > q.y()) != (p[j].y() > q.y())) {
      const double x = p[i].x() + (q.y() - p[i].y()) * (p[j].x() - p[i].x()) / (p[j].y() - p[i].y());
      if (q.x() < x) inside = !inside;
    }
  }
  return inside;
}

double distance(const Polyline& line, const Pixel& q) {
  const auto& p = line.points;
  double best = std::numeric_limits<double>::infinity();
  if (p.size() == 1) return (q - p[0]).norm();
  for (std::size_t i = 0; i < segmentCount(line); ++i) {
    const Pixel a = p[i], d = p[(i + 1) % p.size()] - a;
    const double dd = d.squaredNorm();
    const double t = dd > 0 ? std::clamp((q - a).dot(d) / dd, 0.0, 1.0) : 0.0;
    best = std::min(best, (a + t * d - q).squaredNorm());
  }
  return std::sqrt(best);
}

std::optional<double> reach(const Polyline& line, const Pixel& origin, double direction) {
  const Pixel along(std::cos(direction), std::sin(direction));
  std::optional<double> farthest;
  const std::size_t n = line.points.size();
  for (std::size_t i = 0; i < segmentCount(line); ++i) {
    const Pixel a = line.points[i] - origin, b = line.points[(i + 1) % n] - origin;
    const double sideA = cross(along, a), sideB = cross(along, b);
    if (!((sideA <= 0) != (sideB <= 0))) continue;  // half open, so that a vertex on the line counts once
    const double t = sideA / (sideA - sideB);
    const double distance = along.dot(a + t * (b - a));
    if (distance >= 0 && (!farthest || distance > *farthest)) farthest = distance;
  }
  return farthest;
}

std::vector<Pixel> resample(const Polyline& line, int n) {
  require(n >= 1 && !line.points.empty(), "resample: needs points");
  const double total = length(line);
  std::vector<Pixel> out;
  out.reserve(n);
  const std::size_t count = line.points.size();
  std::size_t segment = 0;
  double start = 0;
  for (int i = 0; i < n; ++i) {
    const double s = line.closed ? total * i / n : (n == 1 ? 0 : total * i / (n - 1));
    while (true) {
      if (segmentCount(line) == 0) {
        out.push_back(line.points[0]);
        break;
      }
      const Pixel &a = line.points[segment], &b = line.points[(segment + 1) % count];
      const double l = (b - a).norm();
      if (s <= start + l || segment + 1 == segmentCount(line)) {
        out.push_back(l > 0 ? Pixel(a + std::clamp((s - start) / l, 0.0, 1.0) * (b - a)) : a);
        break;
      }
      start += l;
      ++segment;
    }
  }
  return out;
}

std::vector<Pixel> thinned(const Polyline& line, int n) {
  require(n >= 1 && !line.points.empty(), "thinned: needs points");
  const std::size_t count = line.points.size();
  if (count <= static_cast<std::size_t>(n)) return line.points;
  std::vector<double> at{0};  // arc length of each point, and of the end
  for (std::size_t i = 1; i < count + (line.closed ? 1 : 0); ++i)
    at.push_back(at.back() + (line.points[i % count] - line.points[i - 1]).norm());
  const double step = at.back() / (line.closed ? n : std::max(1, n - 1));
  std::vector<Pixel> out;
  std::size_t next = 0;
  for (int i = 0; i < n; ++i) {
    std::size_t nearest = next;
    while (nearest + 1 < count && std::abs(at[nearest + 1] - i * step) <= std::abs(at[nearest] - i * step)) ++nearest;
    if (nearest >= count) break;
    out.push_back(line.points[nearest]);
    next = nearest + 1;
  }
  return out;
}

Polyline withoutRepeats(const Polyline& line, double tolerance) {
  Polyline out{{}, line.closed};
  for (const Pixel& p : line.points)
    if (out.points.empty() || (p - out.points.back()).norm() > tolerance) out.points.push_back(p);
  while (out.closed && out.points.size() > 1 && (out.points.front() - out.points.back()).norm() <= tolerance)
    out.points.pop_back();
  return out;
}

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

bool runsAlongImageBorder(const Camera& camera, const Polyline& line) {
  constexpr double kLeastPx = 2;  // a shorter piece may be one chord of a level set
  double along = 0;
  const std::vector<Pixel>& p = line.points;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Pixel &a = p[i], &b = p[(i + 1) % p.size()];
    if (alongImageBorder(camera, a, b)) along += (b - a).norm();
  }
  return along > kLeastPx;
}

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
