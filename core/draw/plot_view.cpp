// SPDX-License-Identifier: BSD-3-Clause
#include "core/draw/plot_view.h"

#include <algorithm>
#include <cmath>

namespace glint::draw {

namespace {
constexpr double kCoincides = 0.3;  // of the reach of a click: nearer points are seen as one
}  // namespace

void PlotView::show(const PlotData& plot) {
  const PlotRange range = rangeOf(plot);
  const bool same = plot.id == plot_.id && range.x0 == whole_.x0 && range.x1 == whole_.x1;
  const bool keep = same && zoomed();
  plot_ = plot;
  whole_ = range;
  if (!keep) shown_ = range;
  marks_.hovered.reset();
  marks_.selected = selectedSamples(plot_, selection_);
  places_.reset();
}

void PlotView::setSelection(const Selection& selection) {
  selection_ = selection;
  marks_.selected = selectedSamples(plot_, selection);
}

void PlotView::paint(Painter& painter, double width, double height) {
  places_ = paintPlot(painter, plot_, style_, shown_, marks_, width, height);
}

const PlotPoint& PlotView::pointOf(const PlotSample& sample) const {
  return plot_.series[std::size_t(sample.series)].points[std::size_t(sample.point)];
}

/// The sample nearer to a place than `reach`; bars have none. @param model  only its samples; "" = all
std::optional<PlotSample> PlotView::nearest(const Eigen::Vector2d& place, double reach, const std::string& model) const {
  std::optional<PlotSample> best;
  for (int s = 0; s < int(plot_.series.size()); ++s) {
    const PlotSeries& series = plot_.series[std::size_t(s)];
    if (series.shape == PlotShape::Bars) continue;
    for (int i = 0; i < int(series.points.size()); ++i) {
      const PlotPoint& p = series.points[std::size_t(i)];
      if (!model.empty() && p.target.model != model) continue;
      const Eigen::Vector2d at = places_->placeOf(plot_, s, p);  // not finite for a gap
      if (!places_->inside(plot_, at)) continue;
      const double distance = (at - place).norm();
      if (distance < reach) reach = distance, best = PlotSample{s, i};
    }
  }
  return best;
}

std::optional<Eigen::Vector2d> PlotView::positionOf(const PlotSample& sample) const {
  if (!places_ || sample.series < 0 || sample.series >= int(plot_.series.size())) return std::nullopt;
  if (sample.point < 0 || sample.point >= int(plot_.series[std::size_t(sample.series)].points.size())) return std::nullopt;
  const Eigen::Vector2d at = places_->placeOf(plot_, sample.series, pointOf(sample));  // not finite for a gap
  if (!places_->inside(plot_, at)) return std::nullopt;
  return at;
}

std::optional<PlotSample> PlotView::at(const Eigen::Vector2d& place, double reach) const {
  if (!places_) return std::nullopt;
  for (int s = 0; s < int(plot_.series.size()); ++s) {
    const PlotSeries& series = plot_.series[std::size_t(s)];
    if (series.shape != PlotShape::Bars) continue;
    for (int i = 0; i < int(series.points.size()); ++i) {
      const double x = series.points[std::size_t(i)].x;
      const double x0 = places_->xOf(plot_, x - 0.5 * series.barWidth), x1 = places_->xOf(plot_, x + 0.5 * series.barWidth);
      if (place.x() >= x0 && place.x() < x1 && place.y() >= places_->top && place.y() <= places_->bottom) return PlotSample{s, i};
    }
  }
  const std::optional<PlotSample> best = nearest(place, reach, "");
  if (!best || selection_.model.empty() || pointOf(*best).target.model == selection_.model) return best;
  // Where points lie on one another the selected model stays, whichever of them is drawn on top.
  const std::optional<PlotSample> own =
      nearest(places_->placeOf(plot_, best->series, pointOf(*best)), kCoincides * reach, selection_.model);
  return own ? own : best;
}

void PlotView::zoom(double factor, const Eigen::Vector2d& about, bool both) {
  if (!places_ || plot_.dial || !(factor > 0)) return;
  const double fx = std::clamp((about.x() - places_->left) / (places_->right - places_->left), 0.0, 1.0);
  const double fy = std::clamp((places_->bottom - about.y()) / (places_->bottom - places_->top), 0.0, 1.0);
  const auto change = [factor](double& a, double& b, double at, double low, double high) {
    const double middle = a + at * (b - a), width = std::min((b - a) / factor, high - low);
    a = std::clamp(middle - at * width, low, high - width);
    b = a + width;
  };
  change(shown_.x0, shown_.x1, fx, whole_.x0, whole_.x1);
  if (both) change(shown_.y0, shown_.y1, fy, whole_.y0, whole_.y1);
}

void PlotView::pan(const Eigen::Vector2d& by) {
  if (!places_ || plot_.dial) return;
  const auto move = [](double& a, double& b, double distance, double low, double high) {
    const double allowed = std::clamp(distance, low - a, high - b);
    a += allowed;
    b += allowed;
  };
  move(shown_.x0, shown_.x1, -by.x() / (places_->right - places_->left) * (shown_.x1 - shown_.x0), whole_.x0, whole_.x1);
  move(shown_.y0, shown_.y1, by.y() / (places_->bottom - places_->top) * (shown_.y1 - shown_.y0), whole_.y0, whole_.y1);
}

bool PlotView::zoomed() const {
  const PlotRange &a = shown_, &b = whole_;
  return a.x0 != b.x0 || a.x1 != b.x1 || a.y0 != b.y0 || a.y1 != b.y1;
}

}  // namespace glint::draw
