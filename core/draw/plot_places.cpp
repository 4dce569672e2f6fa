// SPDX-License-Identifier: BSD-3-Clause
#include "core/draw/plot_places.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace glint::draw {

namespace {
constexpr double kCrossRow = 9;  // height of a series' row of crosses, screen px
}  // namespace

double PlotPlaces::xOf(const PlotData& plot, double x) const {
  return left + (along(plot.x, x) - shown.x0) / (shown.x1 - shown.x0) * (right - left);
}

Eigen::Vector2d PlotPlaces::place(const PlotData& plot, double x, double y) const {
  if (plot.dial) {
    const double r =
        radius * (kZeroRadius + kReachOfDial * y / std::max(plot.y.to.value_or(1), std::numeric_limits<double>::min()));
    return centre + std::max(0.0, r) * Eigen::Vector2d(std::cos(x), std::sin(x));
  }
  return {xOf(plot, x), bottom - (along(plot.y, y) - shown.y0) / (shown.y1 - shown.y0) * (bottom - top)};
}

Eigen::Vector2d PlotPlaces::placeOf(const PlotData& plot, int series, const PlotPoint& point) const {
  if (!point.noValue || plot.dial) return place(plot, point.x, point.y);
  const int row = std::max(0, crossRows[std::size_t(series)]);
  return {xOf(plot, point.x), top + scale * kCrossRow * (0.6 + row)};
}

bool PlotPlaces::inside(const PlotData& plot, const Eigen::Vector2d& p) const {
  constexpr double kSlack = 1;
  return p.allFinite() &&
         (plot.dial || (p.x() >= left - kSlack && p.x() <= right + kSlack && p.y() >= top - kSlack && p.y() <= bottom + kSlack));
}

std::vector<int> crossRowsOf(const PlotData& plot) {
  std::vector<int> rows;
  int used = 0;
  for (const PlotSeries& series : plot.series) {
    const bool any = std::any_of(series.points.begin(), series.points.end(), [](const PlotPoint& p) { return p.noValue; });
    rows.push_back(any ? used++ : -1);
  }
  return rows;
}

}  // namespace glint::draw
