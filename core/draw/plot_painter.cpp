// SPDX-License-Identifier: BSD-3-Clause
#include "core/draw/plot_painter.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <utility>

#include "core/draw/plot_header.h"

namespace glint::draw {
namespace {

using Ticks = std::vector<std::pair<double, std::string>>;

class PlotPicture {
 public:
  PlotPicture(Painter& painter, const PlotData& plot, const PlotStyle& style, const PlotRange& shown, double width, double height)
      : painter_(painter), plot_(plot), look_(style), width_(width), height_(height) {
    at_.shown = shown;
    at_.scale = style.scale;
    at_.crossRows = crossRowsOf(plot);
  }
  std::optional<PlotPlaces> paint(const PlotMarks& marks);

 private:
  double px(double screen) const { return look_.px(screen); }
  Box area() const { return {at_.left, at_.top, at_.right - at_.left, at_.bottom - at_.top}; }
  void line(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Colour& colour, double width) {
    painter_.stroke({a, b}, false, colour, px(width));
  }
  void layOut(double head);
  void paintAxes();
  void paintShades();
  void paintBars();
  void paintSeries();
  void paintErrorBars();
  void paintSamples();
  void paintNotes();
  void layOutDial(double head);
  void paintAround(const PlotSeries& series);
  void paintDial();
  void paintMarks(const PlotMarks& marks);
  void ring(const PlotSample& sample, double r, const Colour& colour, double width);

  Painter& painter_;
  const PlotData& plot_;
  const PlotLook look_;
  const double width_, height_;
  PlotPlaces at_;
  Ticks xTicks_, yTicks_;
};

void PlotPicture::layOut(double head) {
  const double small = px(kPlotSmallFont), title = px(1.5 * kPlotFont);
  xTicks_ = ticksOf(plot_.x, at_.shown.x0, at_.shown.x1, std::max(2, int(width_ / px(75))));
  yTicks_ = ticksOf(plot_.y, at_.shown.y0, at_.shown.y1, std::max(2, int((height_ - head) / px(36))));
  double widest = 0;
  for (const auto& [position, label] : yTicks_) widest = std::max(widest, painter_.textWidth(label, small));
  at_.left = px(6) + (plot_.y.title.empty() ? 0 : title) + widest + px(8);
  at_.right = std::max(at_.left + px(10), width_ - px(14));
  at_.top = head + px(6);
  at_.bottom = std::max(at_.top + px(10), height_ - px(4) - (plot_.x.title.empty() ? 0 : title) - small - px(8));
}

void PlotPicture::paintAxes() {
  const double small = px(kPlotSmallFont), font = px(kPlotFont), tick = px(4);
  const double perX = (at_.right - at_.left) / (at_.shown.x1 - at_.shown.x0);
  const double perY = (at_.bottom - at_.top) / (at_.shown.y1 - at_.shown.y0);
  for (const auto& [position, label] : xTicks_) {
    const double x = at_.left + (position - at_.shown.x0) * perX;
    line({x, at_.top}, {x, at_.bottom}, look_.grid, 1);
    line({x, at_.bottom}, {x, at_.bottom + tick}, look_.faded, 1);
    painter_.text({x, at_.bottom + px(6) + small}, label, small, look_.faded, Align::Centre);
  }
  for (const auto& [position, label] : yTicks_) {
    const double y = at_.bottom - (position - at_.shown.y0) * perY;
    line({at_.left, y}, {at_.right, y}, look_.grid, 1);
    line({at_.left - tick, y}, {at_.left, y}, look_.faded, 1);
    painter_.text({at_.left - px(6), y + belowMiddle(small)}, label, small, look_.faded, Align::Right);
  }
  line({at_.left, at_.bottom}, {at_.right, at_.bottom}, look_.faded, 1);
  line({at_.left, at_.top}, {at_.left, at_.bottom}, look_.faded, 1);
  const auto title = [&](const std::string& text, double room) {
    return fitting(text, [&](const std::string& part) { return painter_.textWidth(part, font) <= room; });
  };
  painter_.text({0.5 * (at_.left + at_.right), height_ - px(6)}, title(plot_.x.title, width_ - px(20)), font, look_.faded,
                Align::Centre);
  painter_.text({px(5) + font, 0.5 * (at_.top + at_.bottom)}, title(plot_.y.title, at_.bottom - at_.top + px(20)), font,
                look_.faded, Align::Centre, true);
}

void PlotPicture::paintShades() {
  for (const PlotShade& shade : plot_.shades) {
    const double a = std::clamp(at_.xOf(plot_, shade.from), at_.left, at_.right),
                 b = std::clamp(at_.xOf(plot_, shade.to), at_.left, at_.right);
    painter_.fill({a, at_.top, b - a, at_.bottom - at_.top}, shade.colour, look_.shadeOpacity);
  }
}

void PlotPicture::paintBars() {
  bool any = false;
  for (const PlotSeries& series : plot_.series) {
    if (series.shape != PlotShape::Bars) continue;
    any = true;
    for (const PlotPoint& p : series.points) {
      if (!std::isfinite(p.y)) continue;
      const Eigen::Vector2d a = at_.place(plot_, p.x - 0.5 * series.barWidth, plot_.y.log ? plot_.y.floor : 0),
                            b = at_.place(plot_, p.x + 0.5 * series.barWidth, p.y);
      const double x0 = std::clamp(a.x(), at_.left, at_.right), x1 = std::clamp(b.x(), at_.left, at_.right);
      double y0 = std::clamp(std::min(a.y(), b.y()), at_.top, at_.bottom),
             y1 = std::clamp(std::max(a.y(), b.y()), at_.top, at_.bottom);
      if (y1 - y0 < px(1.5)) y0 = y1 - px(1.5);  // a bar of nothing is still a sample
      painter_.fill({x0, y0, x1 - x0, y1 - y0}, series.colour);
    }
  }
  const double zero = plot_.y.log ? -1 : at_.place(plot_, 0, 0).y();
  if (any && zero > at_.top && zero < at_.bottom) line({at_.left, zero}, {at_.right, zero}, look_.faded, 1);
}

void PlotPicture::paintSeries() {
  for (const PlotSeries& series : plot_.series) {
    if (series.shape == PlotShape::Bars) continue;
    for (const bool halo : {true, false}) {
      if (halo && !series.halo) continue;
      const Colour& colour = halo ? kHalo : series.colour;
      const double more = halo ? 2 : 0;
      if (series.shape != PlotShape::Points) {
        std::vector<Eigen::Vector2d> run;
        const auto finish = [&] {
          painter_.stroke(run, false, colour, px(series.width + more), series.dash, area());
          run.clear();
        };
        for (const PlotPoint& p : series.points) {
          const Eigen::Vector2d at = at_.place(plot_, p.x, p.y);
          if (at.allFinite())
            run.push_back(at);
          else
            finish();
        }
        finish();
      }
      if (series.shape == PlotShape::Line) continue;
      const double r = 0.5 * px(series.pointSize + more);
      for (const PlotPoint& p : series.points) {
        const Eigen::Vector2d at = at_.place(plot_, p.x, p.y);
        if (!at_.inside(plot_, at)) continue;
        if (p.hollow)
          painter_.ring(at, r, colour, px(1.6));
        else
          painter_.disc(at, r, colour);
      }
    }
  }
}

void PlotPicture::paintErrorBars() {
  for (const PlotSeries& series : plot_.series)
    for (const PlotPoint& p : series.points) {
      if (!p.band || !std::isfinite(p.y)) continue;
      const Eigen::Vector2d low = at_.place(plot_, p.x, p.band->first), high = at_.place(plot_, p.x, p.band->second);
      if (!(low.x() >= at_.left && low.x() <= at_.right)) continue;
      const double y0 = std::clamp(low.y(), at_.top, at_.bottom), y1 = std::clamp(high.y(), at_.top, at_.bottom), cap = px(4);
      line({low.x(), y0}, {low.x(), y1}, series.colour, 1.5);
      for (const double y : {y0, y1}) line({low.x() - cap, y}, {low.x() + cap, y}, series.colour, 1.5);
    }
}

/// Crosses and hints. Crosses of several models side by side: each in a row of its own, so that none hides another.
void PlotPicture::paintSamples() {
  constexpr double kReach = 5;  // of a hint, screen px
  for (int s = 0; s < int(plot_.series.size()); ++s) {
    const PlotSeries& series = plot_.series[std::size_t(s)];
    for (const PlotPoint& p : series.points) {
      const Eigen::Vector2d at = at_.placeOf(plot_, s, p);
      if (!at_.inside(plot_, at)) continue;
      if (p.noValue && !plot_.dial) paintCross(painter_, at, series.colour, look_);
      if (p.triangle && !plot_.dial) paintTriangle(painter_, at, series.colour, look_);
      painter_.hint(at, px(kReach), p.label);
    }
  }
}

void PlotPicture::paintNotes() {
  const double font = px(kPlotFont);
  std::vector<Eigen::Vector2d> points;
  std::vector<std::string> notes;
  std::vector<double> widths;
  for (int s = 0; s < int(plot_.series.size()); ++s)
    for (const PlotPoint& p : plot_.series[std::size_t(s)].points) {
      const Eigen::Vector2d at = at_.placeOf(plot_, s, p);
      if (p.note.empty() || !at_.inside(plot_, at)) continue;
      painter_.ring(at, px(9), look_.text, px(1.6));
      points.push_back(at);
      notes.push_back(p.note);
      widths.push_back(painter_.textWidth(p.note, font, true));
    }
  const std::vector<std::optional<Box>> places = notePlaces(points, widths, 1.3 * font, area(), look_.scale);
  for (std::size_t i = 0; i < places.size(); ++i)
    if (places[i]) painter_.text({places[i]->x, places[i]->y + font}, notes[i], font, look_.text, Align::Left, false, true);
}

void PlotPicture::layOutDial(double head) {
  const double room = height_ - head;
  at_.centre = {0.5 * width_, head + 0.5 * room};
  at_.radius = std::max(px(10), 0.5 * std::min(width_, room) - px(16));
}

/// Runs from gap to gap: dashes go on from one sample to the next.
void PlotPicture::paintAround(const PlotSeries& series) {
  const std::vector<PlotPoint>& points = series.points;
  const auto isGap = [](const PlotPoint& p) { return !std::isfinite(p.y); };
  const std::size_t n = points.size(), gap = std::size_t(std::find_if(points.begin(), points.end(), isGap) - points.begin());
  std::vector<Eigen::Vector2d> run;
  for (std::size_t i = 0; i < n; ++i) {
    const PlotPoint& p = points[gap == n ? i : (gap + 1 + i) % n];  // the gap itself is the last
    if (!isGap(p)) run.push_back(at_.place(plot_, p.x, p.y));
    if (!isGap(p) && i + 1 < n) continue;
    painter_.stroke(std::exchange(run, {}), gap == n, series.colour, px(series.width), series.dash);
  }
}

void PlotPicture::paintDial() {
  const double largest = plot_.y.to.value_or(1), small = px(kPlotSmallFont);
  const Eigen::Vector2d& centre = at_.centre;
  const double radius = at_.radius;
  const auto circle = [&](double value, const Colour& colour, double width) {
    painter_.ring(centre, radius * (kZeroRadius + kReachOfDial * value / largest), colour, px(width));
  };
  for (int i = 0; i < 8; ++i) {
    const Eigen::Vector2d d(std::cos(i * std::numbers::pi / 4), std::sin(i * std::numbers::pi / 4));
    line(centre + 0.15 * radius * d, centre + radius * d, look_.grid, 1);
  }
  const Ticks ticks = dialTicks(plot_.y, largest);
  for (const auto& [value, label] : ticks)
    for (const double v : {value, -value}) circle(v, look_.grid, 1);
  circle(0, kHalo, 3.5);
  circle(0, kObserved, 1.75);
  for (const PlotSeries& series : plot_.series) paintAround(series);
  const struct {
    const char* text;
    double x, y;
  } names[] = {{"right", 1, 0}, {"left", -1, 0}, {"up", 0, -1}, {"down", 0, 1}};
  for (const auto& n : names) {
    const Eigen::Vector2d at = centre + (radius + px(n.x != 0 ? 4 : 8)) * Eigen::Vector2d(n.x, n.y);
    painter_.text({at.x(), at.y() + belowMiddle(small)}, n.text, small, look_.faded,
                  n.x > 0   ? Align::Left
                  : n.x < 0 ? Align::Right
                            : Align::Centre);
  }
  const Eigen::Vector2d slanted(std::cos(3 * std::numbers::pi / 8), -std::sin(3 * std::numbers::pi / 8));
  for (const auto& [value, label] : ticks)
    for (const double v : {value, -value}) {
      const Eigen::Vector2d at = centre + radius * (kZeroRadius + kReachOfDial * v / largest) * slanted;
      painter_.text({at.x(), at.y() + belowMiddle(small)}, (v > 0 ? "+" : "-") + label, small, look_.faded, Align::Centre);
    }
  painter_.text({centre.x(), centre.y() + belowMiddle(small)}, "px", small, look_.faded, Align::Centre);
}

void PlotPicture::ring(const PlotSample& sample, double r, const Colour& colour, double width) {
  if (sample.series < 0 || sample.series >= int(plot_.series.size())) return;
  const PlotSeries& series = plot_.series[std::size_t(sample.series)];
  if (sample.point < 0 || sample.point >= int(series.points.size())) return;
  const Eigen::Vector2d at = at_.placeOf(plot_, sample.series, series.points[std::size_t(sample.point)]);
  if (!at_.inside(plot_, at)) return;
  painter_.ring(at, px(r), look_.around, px(width + 2));
  painter_.ring(at, px(r), colour, px(width));
}

void PlotPicture::paintMarks(const PlotMarks& marks) {
  constexpr std::size_t kMany = 24;  // rings around so many pixels are smaller
  const bool many = marks.selected.size() > kMany;
  double last = std::numeric_limits<double>::quiet_NaN();
  for (const PlotSample& m : marks.selected) {
    const PlotSeries& series = plot_.series[std::size_t(m.series)];
    const PlotPoint& p = series.points[std::size_t(m.point)];
    if (plot_.dial || p.x == last || many || (p.target.frame < 0 && !p.target.direction)) continue;
    if (series.shape == PlotShape::Points) continue;
    last = p.x;
    const double x = at_.xOf(plot_, p.x);
    if (x >= at_.left && x <= at_.right) line({x, at_.top}, {x, at_.bottom}, kActiveView, 1.5);
  }
  for (const PlotSample& m : marks.selected) ring(m, many ? 3 : 6, look_.dark ? Colour{1, 1, 1} : kActiveView, many ? 1 : 1.75);
  if (marks.hovered) ring(*marks.hovered, 5, look_.dark ? kLightColour : kHalo, 1.5);
}

std::optional<PlotPlaces> PlotPicture::paint(const PlotMarks& marks) {
  painter_.fill({0, 0, width_, height_}, look_.background);
  const bool empty = !plot_.empty.empty() || plot_.series.empty();
  const double head = paintPlotHeader(painter_, plot_, look_, width_, height_, !empty, true);
  if (empty) {
    const double font = px(kPlotFont), line = 1.4 * font;
    const std::vector<std::string> lines =
        painter_.wrapped(plot_.empty.empty() ? "Nothing to show" : plot_.empty, font, std::max(px(90), width_ - px(30)));
    double y = 0.5 * height_ - 0.5 * line * double(lines.size() - 1) + belowMiddle(font);
    for (const std::string& words : lines) {
      painter_.text({0.5 * width_, y}, words, font, look_.faded, Align::Centre);
      y += line;
    }
    return std::nullopt;
  }
  if (plot_.dial) {
    layOutDial(head);
    paintDial();
  } else {
    layOut(head);
    paintAxes();
    paintShades();
    paintBars();
    paintSeries();
    paintErrorBars();
  }
  paintSamples();
  paintNotes();
  paintMarks(marks);
  return at_;
}

}  // namespace

std::optional<PlotPlaces> paintPlot(Painter& painter, const PlotData& plot, const PlotStyle& style, const PlotRange& shown,
                                    const PlotMarks& marks, double width, double height) {
  return PlotPicture(painter, plot, style, shown, width, height).paint(marks);
}

}  // namespace glint::draw
