// SPDX-License-Identifier: BSD-3-Clause
#include "core/draw/plot_notes.h"

#include <algorithm>

namespace glint::draw {
namespace {

bool meet(const Box& a, const Box& b) {
  return a.x < b.x + b.width && b.x < a.x + a.width && a.y < b.y + b.height && b.y < a.y + a.height;
}

}  // namespace

std::vector<std::optional<Box>> notePlaces(const std::vector<Eigen::Vector2d>& points, const std::vector<double>& widths,
                                           double height, const Box& area, double scale) {
  constexpr double kBeside = 12, kDot = 8;  // screen px: from a point to its name, half the size of a point with its ring
  constexpr int kRows = 4;                  // farther, a name would not be seen as its point's
  std::vector<std::optional<Box>> places(points.size());
  const auto isFree = [&](const Box& r) {
    if (r.x < area.x || r.y < area.y || r.x + r.width > area.x + area.width || r.y + r.height > area.y + area.height)
      return false;
    const double dot = kDot * scale;
    return std::none_of(places.begin(), places.end(),
                        [&](const std::optional<Box>& other) { return other && meet(*other, r); }) &&
           std::none_of(points.begin(), points.end(), [&](const Eigen::Vector2d& p) {
             return meet(r, {p.x() - dot, p.y() - dot, 2 * dot, 2 * dot});
           });
  };
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector2d& p = points[i];
    for (int row = 0; row < kRows && !places[i]; ++row)
      for (const double y : {p.y() - 1.3 * height - row * height, p.y() + 0.3 * height + row * height})
        for (const double x : {p.x() + kBeside * scale, p.x() - kBeside * scale - widths[i]})
          if (const Box place{x, y, widths[i], height}; !places[i] && isFree(place)) places[i] = place;
  }
  return places;
}

}  // namespace glint::draw
