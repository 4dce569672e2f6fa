// SPDX-License-Identifier: BSD-3-Clause
#include "gui/plots/plot_cursor.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

namespace glint::gui {

namespace {
const draw::PlotPoint* pointAt(const draw::PlotData& plot, const draw::PlotSample& s) {
  if (s.series < 0 || s.series >= int(plot.series.size())) return nullptr;
  const std::vector<draw::PlotPoint>& points = plot.series[std::size_t(s.series)].points;
  return s.point >= 0 && s.point < int(points.size()) ? &points[std::size_t(s.point)] : nullptr;
}

std::ptrdiff_t placeOf(const std::vector<draw::PlotSample>& samples, const draw::PlotSample& s) {
  return std::find(samples.begin(), samples.end(), s) - samples.begin();
}
}  // namespace

std::vector<draw::PlotSample> PlotCursor::inOrder(const draw::PlotData& plot, const Where& where) {
  std::vector<std::pair<QPointF, draw::PlotSample>> places;
  for (int s = 0; s < int(plot.series.size()); ++s)
    for (int i = 0; i < int(plot.series[std::size_t(s)].points.size()); ++i)
      if (const std::optional<QPointF> at = where({s, i})) places.push_back({*at, {s, i}});
  std::stable_sort(places.begin(), places.end(), [](const auto& a, const auto& b) {
    return std::tuple(a.first.x(), a.first.y()) < std::tuple(b.first.x(), b.first.y());
  });
  std::vector<draw::PlotSample> samples;
  for (const auto& place : places) samples.push_back(place.second);
  return samples;
}

std::optional<draw::PlotSample> PlotCursor::find(const draw::PlotData& plot, const std::optional<Point>& point) {
  if (!point) return std::nullopt;
  const auto same = [](double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); };  // a cross has no y
  const auto is = [&](const draw::PlotPoint* p) {
    return p && same(p->x, point->x) && same(p->y, point->y) && p->label == point->label;
  };
  if (is(pointAt(plot, point->sample))) return point->sample;
  for (int s = 0; s < int(plot.series.size()); ++s)
    for (int i = 0; i < int(plot.series[std::size_t(s)].points.size()); ++i)
      if (is(pointAt(plot, {s, i}))) return draw::PlotSample{s, i};
  return std::nullopt;
}

bool PlotCursor::move(const draw::PlotData& plot, const Where& where, Step step, bool extend) {
  const std::vector<draw::PlotSample> samples = inOrder(plot, where);
  if (samples.empty()) return false;
  const std::ptrdiff_t last = std::ptrdiff_t(samples.size()) - 1;
  const std::optional<draw::PlotSample> now = sample(plot);
  const std::ptrdiff_t from = now ? placeOf(samples, *now) : std::ptrdiff_t(samples.size());
  std::ptrdiff_t to = step == Step::First || step == Step::Next ? 0 : last;
  if (from <= last && step == Step::Next) to = std::min(from + 1, last);
  if (from <= last && step == Step::Previous) to = std::max<std::ptrdiff_t>(from - 1, 0);
  const draw::PlotSample& there = samples[std::size_t(to)];
  const draw::PlotPoint& p = *pointAt(plot, there);
  if (extend && !from_) from_ = at_;
  at_ = Point{there, p.x, p.y, p.label};
  if (!extend || !from_) from_ = at_;
  return true;
}

std::vector<draw::PlotSample> PlotCursor::range(const draw::PlotData& plot, const Where& where) const {
  const std::optional<draw::PlotSample> begin = find(plot, from_), end = sample(plot);
  if (!end) return {};
  const std::vector<draw::PlotSample> samples = inOrder(plot, where);
  const std::ptrdiff_t b = placeOf(samples, *end), size = std::ptrdiff_t(samples.size());
  const std::ptrdiff_t a = begin && placeOf(samples, *begin) < size ? placeOf(samples, *begin) : b;
  if (b == size) return {*end};
  return {samples.begin() + std::min(a, b), samples.begin() + std::max(a, b) + 1};
}

std::string PlotCursor::words(const draw::PlotData& plot, const Where& where) const {
  const std::optional<draw::PlotSample> now = sample(plot);
  if (!now) return {};
  const std::vector<draw::PlotSample> samples = inOrder(plot, where);
  return std::to_string(placeOf(samples, *now) + 1) + " of " + std::to_string(samples.size()) + ": " + pointAt(plot, *now)->label;
}

}  // namespace glint::gui
