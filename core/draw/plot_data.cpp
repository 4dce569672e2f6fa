// SPDX-License-Identifier: BSD-3-Clause
#include "core/draw/plot_data.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/csv_text.h"
#include "core/base/number_text.h"

namespace glint::draw {
namespace {

constexpr double kSpanOfLog = 30;

double apart(double a, double b) { return std::abs(std::remainder(a - b, 2 * std::numbers::pi)); }

bool fits(const PlotTarget& t, const Selection& s) {
  if (t.frame >= 0 && t.frame != s.frame) return false;
  if (!t.model.empty() && !s.model.empty() && t.model != s.model) return false;
  if (!t.light.empty() && !s.light.empty() && t.light != s.light) return false;
  return t.highlight < 0 || s.highlight < 0 || t.highlight == s.highlight;
}

std::string numberText(double v, const char* format = "%.9g") {
  if (!std::isfinite(v)) return "";
  return formatted(format, v);
}

/// A row is a line.
std::string quoted(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  return csvText(text, CsvQuotes::Always);
}

}  // namespace

bool needsLogAxis(const std::vector<double>& values) {
  double low = std::numeric_limits<double>::infinity(), high = 0;
  for (const double v : values)
    if (v > 0 && std::isfinite(v)) low = std::min(low, v), high = std::max(high, v);
  return high > kSpanOfLog * low;
}

double along(const PlotAxis& axis, double value) { return axis.log ? std::log10(std::max(value, axis.floor)) : value; }

std::vector<PlotSample> selectedSamples(const PlotData& plot, const Selection& selection) {
  std::vector<PlotSample> all;
  for (int s = 0; s < int(plot.series.size()); ++s) {
    const PlotSeries& series = plot.series[std::size_t(s)];
    PlotSample nearest;
    double best = std::numeric_limits<double>::infinity();
    bool found = false;
    for (int p = 0; p < int(series.points.size()); ++p) {
      const PlotPoint& point = series.points[std::size_t(p)];
      const PlotTarget& t = point.target;
      if ((!std::isfinite(point.y) && !point.noValue) || t.setting >= 0 || !fits(t, selection)) continue;
      if (t.direction) {
        if (!selection.direction) continue;
        const double d = apart(*t.direction, *selection.direction);
        if (d <= series.markReach) all.push_back({s, p}), found = true;
        if (d < best) best = d, nearest = {s, p};
      } else if (t.frame >= 0) {
        all.push_back({s, p});
      } else if (!selection.model.empty() && t.model == selection.model) {
        all.push_back({s, p});
      }
    }
    constexpr double kFar = 0.2;  // rad: a contour with a gap there has no sample of this direction
    if (!found && nearest.point >= 0 && best < kFar) all.push_back(nearest);
  }
  return all;
}

Selection selectionOf(const PlotTarget& t, Selection s) {
  if (t.frame >= 0 && t.frame != s.frame) {
    s.frame = t.frame;
    s.highlight = -1;
    s.direction.reset();
  }
  if (!t.model.empty()) s.model = t.model;
  if (!t.light.empty()) s.light = t.light;
  if (t.highlight >= 0) s.highlight = t.highlight;
  if (t.direction) s.direction = t.direction;
  return s;
}

PlotRange rangeOf(const PlotData& plot) {
  double x0 = std::numeric_limits<double>::infinity(), x1 = -x0, y0 = x0, y1 = -x0;
  const auto takeX = [&](double v) {
    if (std::isfinite(v)) x0 = std::min(x0, along(plot.x, v)), x1 = std::max(x1, along(plot.x, v));
  };
  const auto takeY = [&](double v) {
    if (std::isfinite(v)) y0 = std::min(y0, along(plot.y, v)), y1 = std::max(y1, along(plot.y, v));
  };
  for (const PlotSeries& series : plot.series)
    for (const PlotPoint& p : series.points) {
      if (p.noValue) takeX(p.x);
      if (!std::isfinite(p.y)) continue;
      const double half = series.shape == PlotShape::Bars ? 0.5 * series.barWidth : 0;
      takeX(p.x - half);
      takeX(p.x + half);
      takeY(p.y);
      if (p.band) takeY(p.band->first), takeY(p.band->second);
      if (series.shape == PlotShape::Bars && !plot.y.log) takeY(0);
    }
  for (const auto& [position, text] : plot.x.names) takeX(position - 0.5), takeX(position + 0.5);
  const auto widened = [](double& a, double& b, double margin) {
    if (!(a <= b)) a = 0, b = 1;
    const double width = b > a ? b - a : std::max(std::abs(a), 1.0);
    a -= margin * width;
    b += margin * width;
  };
  widened(x0, x1, 0.02);
  widened(y0, y1, 0.06);
  PlotRange r{x0, x1, y0, y1};
  if (plot.x.from) r.x0 = along(plot.x, *plot.x.from);
  if (plot.x.to) r.x1 = along(plot.x, *plot.x.to);
  if (plot.y.from) r.y0 = along(plot.y, *plot.y.from);
  if (plot.y.to) r.y1 = along(plot.y, *plot.y.to);
  if (!(r.x1 > r.x0)) r.x1 = r.x0 + 1;
  if (!(r.y1 > r.y0)) r.y1 = r.y0 + 1;
  return r;
}

std::vector<std::pair<double, std::string>> ticksOf(const PlotAxis& axis, double from, double to, int most) {
  std::vector<std::pair<double, std::string>> ticks;
  if (!(to > from) || most < 1) return ticks;
  if (!axis.names.empty()) {
    std::vector<std::pair<double, std::string>> inside;
    for (const auto& [position, text] : axis.names)
      if (position >= from && position <= to) inside.emplace_back(position, text);
    const std::size_t every = (inside.size() + std::size_t(most) - 1) / std::size_t(most);
    for (std::size_t i = 0; i < inside.size(); i += std::max<std::size_t>(1, every)) ticks.push_back(inside[i]);
    return ticks;
  }
  if (axis.log && to - from > 0.9) {
    const int decades = int(std::floor(to)) - int(std::ceil(from)) + 1;
    const int step = std::max(1, (decades + most - 1) / most);
    const bool between = decades * 3 <= most;
    for (int d = int(std::floor(from)); d <= int(std::ceil(to)); ++d)
      for (const double m : {1.0, 2.0, 5.0}) {
        if ((m > 1 && !between) || (m == 1 && d % step != 0)) continue;
        const double at = d + std::log10(m);
        if (at >= from && at <= to) ticks.emplace_back(at, numberText(m * std::pow(10.0, d), d >= -4 && d < 6 ? "%.6g" : "%.3g"));
      }
    return ticks;
  }
  // 1, 2 or 5 times a power of ten; on a short logarithmic axis the same between the values at its ends.
  const double low = axis.log ? std::pow(10.0, from) : from, high = axis.log ? std::pow(10.0, to) : to;
  const double rough = (high - low) / most, power = std::pow(10.0, std::floor(std::log10(rough)));
  double step = power * (rough / power <= 1.0001 ? 1 : rough / power <= 2 ? 2 : rough / power <= 5 ? 5 : 10);
  if (axis.counts) step = std::max(1.0, step);
  for (double k = std::ceil(low / step); k * step <= high; ++k) {
    const double value = k == 0 ? 0 : k * step;
    if (axis.counts && value < 0) continue;
    ticks.emplace_back(axis.log ? std::log10(value) : value, numberText(value, "%.6g"));
    if (int(ticks.size()) > 4 * most) break;
  }
  return ticks;
}

std::vector<std::pair<double, std::string>> dialTicks(const PlotAxis& axis, double largest) {
  constexpr int kMost = 8;  // a step of a quarter of the range is always met before
  std::vector<std::pair<double, std::string>> ticks;
  for (int most = 2; ticks.empty() && most <= kMost; ++most) {
    ticks = ticksOf(axis, 0, largest, most);
    std::erase_if(ticks, [](const auto& tick) { return !(tick.first > 0); });
  }
  return ticks;
}

std::string fitting(const std::string& title, const std::function<bool(const std::string&)>& fits) {
  if (fits(title)) return title;
  // Words go from the front: what is measured can be told from the plot's title, the unit of its numbers from nowhere else.
  const std::size_t unit = title.rfind(" (");
  if (unit == std::string::npos) return {};
  for (std::size_t at = title.find(' '); at != std::string::npos && at <= unit; at = title.find(' ', at + 1))
    if (const std::string part = title.substr(at + 1); fits(part)) return part;
  if (const std::size_t more = title.find(';', unit); more != std::string::npos)  // "(m; lowest = 0)"
    if (const std::string alone = title.substr(unit + 1, more - unit - 1) + ")"; fits(alone)) return alone;
  return {};
}

std::string plotCsv(const PlotData& plot) {
  std::string csv = "series," + quoted(plot.x.title) + "," + quoted(plot.y.title) +
                    ",lower,upper,index,model,light,highlight,direction,label\n";
  for (const PlotSeries& series : plot.series)
    for (const PlotPoint& p : series.points) {
      const PlotTarget& t = p.target;
      csv += quoted(series.name) + "," + numberText(p.x) + "," + numberText(p.y) + "," +
             (p.band ? numberText(p.band->first) : "") + "," + (p.band ? numberText(p.band->second) : "") + "," +
             (t.frame >= 0 ? std::to_string(t.frame) : "") + "," + quoted(t.model) + "," + quoted(t.light) + "," +
             (t.highlight >= 0 ? std::to_string(t.highlight) : "") + "," + (t.direction ? numberText(*t.direction) : "") + "," +
             quoted(p.label) + "\n";
    }
  return csv;
}

}  // namespace glint::draw
