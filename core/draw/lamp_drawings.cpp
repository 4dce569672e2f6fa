// SPDX-License-Identifier: BSD-3-Clause
#include "core/draw/lamp_drawings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/base/number_text.h"
#include "core/draw/colours.h"

namespace glint::draw {

namespace {

constexpr Colour kDrawnByHand{0.95, 0.75, 0.20};  // a person's outline; dashed, so that it is told apart without its colour
constexpr Colour kArrow{0.90, 0.25, 0.25};
/// Colours of the balls, from Okabe and Ito's palette, which all eyes can tell apart.
constexpr std::array<Colour, 6> kBallColours{{{0.337, 0.706, 0.914},
                                              {0.902, 0.624, 0.000},
                                              {0.000, 0.620, 0.451},
                                              {0.800, 0.475, 0.655},
                                              {0.835, 0.369, 0.000},
                                              {0.941, 0.894, 0.259}}};
constexpr int kCirclePoints = 144;
constexpr double kLongestArrow = 0.125;  // of the smallest ball's radius: beyond, arrows of several highlights would cross
constexpr double kMostEnlarged = 100;    // more would draw what is exact as if it were not
constexpr double kArrowHead = 0.25;      // of an arrow's length
constexpr double kShareOfBars = 0.8;     // of the room of a photograph; the rest parts it from the next one

std::string ballName(std::size_t ball) { return "ball " + std::to_string(ball + 1); }

std::vector<Pixel> circleOf(const BallOutline& outline, const Eigen::Vector2d& corner) {
  std::vector<Pixel> points;
  for (int k = 0; k < kCirclePoints; ++k) {
    const double t = 2 * M_PI * k / kCirclePoints;
    points.emplace_back(outline.centre - corner + outline.radius * Eigen::Vector2d(std::cos(t), std::sin(t)));
  }
  return points;
}

void addMark(FrameOverlay& overlay, const Pixel& at, MarkShape shape, const Colour& colour, double size,
             const std::string& label) {
  OverlayMark mark;
  mark.at = at;
  mark.shape = shape;
  mark.colour = colour;
  mark.size = size;
  mark.label = label;
  overlay.marks.push_back(mark);
}

/// The arrow from the predicted to the seen place.
void addArrow(FrameOverlay& overlay, const Pixel& seen, const Eigen::Vector2d& residual, double scale, const std::string& label) {
  const Eigen::Vector2d by = scale * residual, side(-by.y(), by.x());
  const Pixel to = seen + by;
  OverlayLine line;
  line.role = OverlayRole::ResidualArrows;
  line.colour = kArrow;
  line.width = 2;
  line.halo = true;
  line.label = label;
  line.points = {seen, to, to - kArrowHead * (by + 0.5 * side), to, to - kArrowHead * (by - 0.5 * side)};
  overlay.lines.push_back(line);
}

void addFit(FrameOverlay& overlay, const BallOverlayInput& in) {
  for (const std::size_t k : in.balls) {
    if (k >= in.fit->balls.size()) continue;
    OverlayLine line;
    for (const Pixel& p : in.fit->balls[k].outline) line.points.push_back(p - in.corner);
    line.closed = true;
    line.colour = kMeasuredLamp;
    line.halo = true;
    line.label = ballName(k) + ", refined outline";
    overlay.lines.push_back(line);
  }
  if (!in.lamp) return;
  const auto here = [&](std::size_t ball) { return std::count(in.balls.begin(), in.balls.end(), ball) > 0; };
  for (const LampSighting& s : in.lamp->sightings) {
    if (!here(s.ball)) continue;
    const std::string label =
        ballName(s.ball) + formatted(": highlight, %.3g px from where the fit predicts it", s.residualPx.norm());
    addMark(overlay, s.peak - in.corner, MarkShape::Circle, kMeasuredLamp, 6, label);
    if (s.residualPx.norm() > 0) addArrow(overlay, s.peak - in.corner, s.residualPx, in.residualScale, label);
  }
  for (const DroppedSighting& d : in.lamp->dropped)
    if (d.ball && here(*d.ball)) addMark(overlay, d.place - in.corner, MarkShape::Cross, kArrow, 5, "not used: " + d.reason);
}

}  // namespace

FrameOverlay ballOverlay(const BallOverlayInput& in) {
  FrameOverlay overlay;
  for (std::size_t k = 0; k < in.drawn.size(); ++k) {
    OverlayLine line;
    line.points = circleOf(in.drawn[k], in.corner);
    line.closed = true;
    line.colour = kDrawnByHand;
    line.width = static_cast<int>(k) == in.selected ? 3 : 1.5;
    line.dash = Dash::Dashed;
    line.halo = true;
    line.label = "outline as drawn: drag its middle or its rim";
    overlay.lines.push_back(line);
    addMark(overlay, in.drawn[k].centre - in.corner, MarkShape::Cross, kDrawnByHand, static_cast<int>(k) == in.selected ? 7 : 5,
            "middle of the outline: drag it");
  }
  for (const Eigen::Vector2d& p : in.rim) addMark(overlay, p - in.corner, MarkShape::Circle, kDrawnByHand, 5, "point of the rim");
  if (in.fit) addFit(overlay, in);
  return overlay;
}

double ballResidualScale(const std::vector<FittedBall>& balls, const std::vector<LampAnswer>& lamps) {
  double longest = 0, radius = std::numeric_limits<double>::infinity();
  for (const LampAnswer& lamp : lamps)
    for (const LampSighting& s : lamp.sightings) longest = std::max(longest, s.residualPx.norm());
  for (const FittedBall& ball : balls) {
    Eigen::AlignedBox2d box;
    for (const Pixel& p : ball.outline) box.extend(p);
    if (!box.isEmpty()) radius = std::min(radius, 0.5 * box.sizes().minCoeff());
  }
  if (!(longest > 0) || !std::isfinite(radius)) return 1;
  const double most = std::min(kMostEnlarged, kLongestArrow * radius / longest);
  double scale = 1;
  for (const double next : {2.0, 5.0, 10.0, 20.0, 50.0, 100.0})
    if (next <= most) scale = next;
  return scale;
}

namespace {

/// One place along x for each photograph, named.
PlotAxis photographAxis(const std::vector<LampAnswer>& lamps) {
  PlotAxis axis;
  axis.title = "photograph";
  axis.from = -0.5;
  axis.to = static_cast<double>(lamps.size()) - 0.5;
  for (std::size_t i = 0; i < lamps.size(); ++i)
    axis.names.emplace_back(static_cast<double>(i), lamps[i].frames.empty() ? lamps[i].id : lamps[i].frames.front());
  return axis;
}

PlotPoint photographPoint(const LampAnswer& lamp, std::size_t index, double x, double y, const std::string& label) {
  PlotPoint point;
  point.x = x;
  point.y = y;
  point.label = (lamp.frames.empty() ? lamp.id : lamp.frames.front()) + ": " + label;
  point.target.frame = static_cast<int>(index);
  point.target.light = lamp.id;
  return point;
}

/// Nothing but its axes.
PlotData photographPlot(const std::vector<LampAnswer>& lamps, const char* id, const char* title, const char* values) {
  PlotData plot;
  plot.id = id;
  plot.title = title;
  plot.x = photographAxis(lamps);
  plot.y.title = values;
  plot.y.from = 0;
  plot.noValue = "no answer";
  return plot;
}

PlotPoint withoutAnswer(const LampAnswer& lamp, std::size_t index, double x) {
  PlotPoint point = photographPoint(lamp, index, x, std::numeric_limits<double>::quiet_NaN(), "no answer");
  if (lamp.failure) point.label += ": " + lamp.failure->message();
  point.noValue = true;
  return point;
}

}  // namespace

PlotData ballResidualPlot(const std::vector<LampAnswer>& lamps, std::size_t balls) {
  PlotData plot = photographPlot(lamps, "ball-residuals", "Residual of every highlight", "seen less predicted (px)");
  if (lamps.empty()) plot.empty = "No photograph was measured.";
  if (balls == 1)
    plot.empty = "One ball: nothing is redundant, so no residual tells anything. A second ball in the same photographs does.";
  const double width = kShareOfBars / static_cast<double>(std::max<std::size_t>(1, balls));
  for (std::size_t k = 0; k < balls; ++k) {
    PlotSeries bars, alone;
    bars.name = ballName(k);
    bars.colour = alone.colour = kBallColours[k % kBallColours.size()];
    bars.shape = PlotShape::Bars;
    bars.barWidth = width;
    alone.name = ballName(k) + " from the others";
    alone.shape = PlotShape::Points;
    for (std::size_t i = 0; i < lamps.size(); ++i) {
      const double x = static_cast<double>(i) + (static_cast<double>(k) + 0.5) * width - 0.5 * kShareOfBars;
      if (lamps[i].failure) {
        if (k == 0) bars.points.push_back(withoutAnswer(lamps[i], i, static_cast<double>(i)));
        continue;
      }
      for (const LampSighting& s : lamps[i].sightings) {
        if (s.ball != k) continue;
        bars.points.push_back(
            photographPoint(lamps[i], i, x, s.residualPx.norm(), formatted("%.3g px on ", s.residualPx.norm()) + ballName(k)));
        if (!s.leftOutPx) continue;
        alone.points.push_back(
            photographPoint(lamps[i], i, x, s.leftOutPx->norm(),
                            formatted("%.3g px from where the other balls alone predict it", s.leftOutPx->norm())));
        alone.points.back().hollow = true;
      }
    }
    plot.series.push_back(std::move(bars));
    if (!alone.points.empty()) plot.series.push_back(std::move(alone));
  }
  return plot;
}

PlotData outlineSharePlot(const std::vector<LampAnswer>& lamps) {
  constexpr double kPercent = 100;
  PlotData plot =
      photographPlot(lamps, "outline-shares", "What each photograph says of the outlines", "share of information (%)");
  PlotSeries bars;
  bars.name = "highlights of the photograph";
  bars.colour = kBallColours.front();
  bars.shape = PlotShape::Bars;
  bars.barWidth = kShareOfBars;
  double sum = 0;
  for (std::size_t i = 0; i < lamps.size(); ++i) {
    const double x = static_cast<double>(i);
    if (lamps[i].failure || !lamps[i].outlineShare) {
      bars.points.push_back(withoutAnswer(lamps[i], i, x));
      continue;
    }
    const double share = kPercent * *lamps[i].outlineShare;
    sum += share;
    bars.points.push_back(photographPoint(lamps[i], i, x, share, formatted("%.3g %% of what is known of the outlines", share)));
  }
  constexpr double kNothing = 1e-9;  // percent: round-off
  if (!(sum > kNothing))
    plot.empty =
        "The highlights say nothing of the outlines: one ball, or outlines that are taken as they are. All that is known comes "
        "from the edges.";
  else
    plot.title += formatted(" (together %.3g %%, the edges the rest)", sum);
  plot.series.push_back(std::move(bars));
  return plot;
}

}  // namespace glint::draw
