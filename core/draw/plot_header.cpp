// SPDX-License-Identifier: BSD-3-Clause
#include "core/draw/plot_header.h"

#include <algorithm>
#include <functional>
#include <string>
#include <vector>

namespace glint::draw {

namespace {

constexpr double kLine = 18;                         // height of a line, screen px
constexpr double kLeastPlot = 100, kLeastDial = 90;  // height that the legend leaves to a plot with its axes, screen px
constexpr double kSwatch = 18;                       // width of the sign before a name, screen px

/// One entry of the legend: what is drawn from the left end of its swatch about the line's middle, and its name.
struct Entry {
  std::string name;
  std::function<void(double left, double middle)> paint;  ///< empty: a remark, which is a text alone
};

bool hasCrosses(const PlotData& plot) {
  for (const PlotSeries& series : plot.series)
    for (const PlotPoint& p : series.points)
      if (p.noValue) return true;
  return false;
}

bool hasTriangles(const PlotData& plot) {
  return std::any_of(plot.series.begin(), plot.series.end(), [](const PlotSeries& series) {
    return std::any_of(series.points.begin(), series.points.end(), [](const PlotPoint& p) { return p.triangle; });
  });
}

void paintSwatch(Painter& painter, const PlotSeries& series, const PlotLook& look, double left, double middle) {
  const double swatch = look.px(kSwatch);
  for (const bool halo : {true, false}) {
    if (halo && !series.halo) continue;
    const Colour& colour = halo ? kHalo : series.colour;
    const double more = halo ? look.px(2) : 0;
    if (series.shape == PlotShape::Line || series.shape == PlotShape::LineAndPoints) {
      painter.stroke({{left, middle}, {left + swatch, middle}}, false, colour, look.px(std::max(2.0, series.width)) + more,
                     halo ? Dash::Solid : series.dash);
    } else if (series.shape == PlotShape::Bars) {
      const double r = look.px(5) + 0.5 * more;
      painter.fill({left + 0.5 * swatch - r, middle - r, 2 * r, 2 * r}, colour);
    } else {
      painter.disc({left + 0.5 * swatch, middle}, std::max(look.px(3), 0.5 * look.px(series.pointSize)) + 0.5 * more, colour);
    }
  }
}

std::vector<Entry> entriesOf(Painter& painter, const PlotData& plot, const PlotLook& look) {
  const double swatch = look.px(kSwatch);
  std::vector<Entry> entries;
  for (const std::string& remark : plot.remarks) entries.push_back({remark, {}});
  for (const PlotSeries& series : plot.series)
    if (series.inLegend)
      entries.push_back({series.name, [&](double left, double middle) { paintSwatch(painter, series, look, left, middle); }});
  if (!plot.noValue.empty() && hasCrosses(plot))
    entries.push_back({plot.noValue, [&painter, &look, swatch](double left, double middle) {
                         paintCross(painter, {left + 0.5 * swatch, middle}, look.faded, look);
                       }});
  if (!plot.triangles.empty() && hasTriangles(plot))
    entries.push_back({plot.triangles, [&painter, &look, swatch](double left, double middle) {
                         paintTriangle(painter, {left + 0.5 * swatch, middle}, look.faded, look);
                       }});
  std::vector<std::string> named;
  for (const PlotShade& shade : plot.shades) {
    if (shade.name.empty() || std::find(named.begin(), named.end(), shade.name) != named.end()) continue;
    named.push_back(shade.name);
    entries.push_back({shade.name, [&painter, &look, &shade, swatch](double left, double middle) {
                         painter.fill({left + look.px(3), middle - look.px(5), swatch - look.px(6), look.px(10)}, shade.colour,
                                      std::min(1.0, 1.5 * look.shadeOpacity));
                       }});
  }
  return entries;
}

}  // namespace

void paintTriangle(Painter& painter, const Eigen::Vector2d& at, const Colour& colour, const PlotLook& look) {
  const double half = look.px(6.5), low = half / 1.732;  // equilateral about its middle
  painter.stroke({at + Eigen::Vector2d(-half, low), at + Eigen::Vector2d(half, low), at + Eigen::Vector2d(0, -2 * low)}, true,
                 colour, look.px(1.5));
}

void paintCross(Painter& painter, const Eigen::Vector2d& at, const Colour& colour, const PlotLook& look) {
  constexpr double kHalf = 3.5, kWidth = 1.75;  // screen px
  for (const bool outer : {true, false}) {
    const double r = look.px(outer ? kHalf + 0.6 * kWidth : kHalf);
    for (const Eigen::Vector2d& arm : {Eigen::Vector2d(r, r), Eigen::Vector2d(r, -r)})
      painter.stroke({at - arm, at + arm}, false, outer ? look.around : colour, look.px(outer ? 2.2 * kWidth : kWidth));
  }
}

double paintPlotHeader(Painter& painter, const PlotData& plot, const PlotLook& look, double width, double height, bool legend,
                       bool draw) {
  const double lineHeight = look.px(kLine), margin = look.px(8), swatch = look.px(kSwatch), small = look.px(kPlotSmallFont);
  const double gap = look.px(5);
  double y = 0.5 * lineHeight + look.px(2), x = margin;  // y: the line's middle
  if (draw)
    painter.text({x, y + belowMiddle(look.px(kPlotFont))}, plot.title, look.px(kPlotFont), look.text, Align::Left, false, true);
  x += painter.textWidth(plot.title, look.px(kPlotFont), true) + look.px(18);
  const double lowest = height - look.px(plot.dial ? kLeastDial : kLeastPlot) - 0.5 * lineHeight;
  for (const Entry& entry : legend ? entriesOf(painter, plot, look) : std::vector<Entry>{}) {
    const double before = entry.paint ? swatch + gap : 0;
    const double needed = before + painter.textWidth(entry.name, small) + look.px(14);
    if (x + needed > width - margin && x > margin) {
      if (y + lineHeight > lowest) {
        const std::string dots = "\u2026";
        if (draw)
          painter.text({std::min(x, width - margin - painter.textWidth(dots, small)), y + belowMiddle(small)}, dots, small,
                       look.text);
        break;
      }
      x = margin;
      y += lineHeight;
    }
    if (draw) {
      if (entry.paint) entry.paint(x, y);
      painter.text({x + before, y + belowMiddle(small)}, entry.name, small, look.text);
    }
    x += needed;
  }
  return y + 0.5 * lineHeight;
}

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
