// SPDX-License-Identifier: BSD-3-Clause
#include "viz/plots/plot_view.h"

#include <vtkAxis.h>
#include <vtkBrush.h>
#include <vtkChartXY.h>
#include <vtkContext2D.h>
#include <vtkContextActor.h>
#include <vtkContextDevice2D.h>
#include <vtkContextItem.h>
#include <vtkContextScene.h>
#include <vtkDoubleArray.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>
#include <vtkPen.h>
#include <vtkPlotLine.h>
#include <vtkRenderer.h>
#include <vtkStringArray.h>
#include <vtkTable.h>
#include <vtkTextProperty.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <vector>

#include "viz/plots/painting.h"
#include "viz/plots/plot_header.h"

namespace glint::viz {
namespace {

constexpr double kFont = 12, kSmallFont = 11;  // screen px
constexpr double kCross = 3.5, kCrossRow = 9;  // half size of a cross at the top, height of a series' row of them; screen px
constexpr double kCoincides = 0.3;             // of the reach of a click: nearer points are seen as one
constexpr Colour kHalo{0.12, 0.13, 0.15};
// A dial's circle of zero and how far the largest residual goes from it, in radii of the dial.
constexpr double kZeroRadius = 0.58, kReachOfDial = 0.36;

/// An item of the scene that a function paints.
class PaintItem : public vtkContextItem {
 public:
  vtkTypeMacro(PaintItem, vtkContextItem);
  static PaintItem* New();
  bool Paint(vtkContext2D* painter) override {
    if (paint) paint(painter);
    return true;
  }
  std::function<void(vtkContext2D*)> paint;

 protected:
  PaintItem() = default;
};
vtkStandardNewMacro(PaintItem)

}  // namespace

struct PlotView::Impl {
  vtkNew<vtkRenderer> renderer;
  vtkNew<vtkContextActor> actor;
  vtkNew<PaintItem> before, after;
  vtkNew<vtkChartXY> chart;
  PlotData plot;
  PlotStyle style;
  Selection selection;
  std::vector<PlotSample> marked;
  std::optional<PlotSample> hovered;
  std::vector<int> crossRows;  // of each series: where its crosses stand, counted from the top; -1 without any
  PlotRange whole, shown;
  // Of the last picture, scene px (y up).
  bool painted = false;
  double left = 0, right = 1, bottom = 0, top = 1, sceneHeight = 1;
  Eigen::Vector2d centre{0, 0};
  double radius = 1;

  Colour text() const { return style.dark ? kTextOnDark : kTextOnLight; }
  Colour faded() const { return style.dark ? Colour{0.64, 0.66, 0.68} : Colour{0.36, 0.38, 0.41}; }
  Colour grid() const { return style.dark ? Colour{0.24, 0.255, 0.275} : Colour{0.86, 0.87, 0.88}; }
  double px(double screen) const { return screen * style.scale; }
  bool isEmpty() const { return !plot.empty.empty() || plot.series.empty(); }

  /// Scene px of a value, y up; not finite for a gap.
  Eigen::Vector2d place(double x, double y) const {
    if (plot.dial) {
      const double r =
          radius * (kZeroRadius + kReachOfDial * y / std::max(plot.y.to.value_or(1), std::numeric_limits<double>::min()));
      return centre + std::max(0.0, r) * Eigen::Vector2d(std::cos(x), -std::sin(x));
    }
    return {left + (along(plot.x, x) - shown.x0) / (shown.x1 - shown.x0) * (right - left),
            bottom + (along(plot.y, y) - shown.y0) / (shown.y1 - shown.y0) * (top - bottom)};
  }
  /// The same for a sample; that of one without a value is its cross.
  Eigen::Vector2d placeOf(int series, const PlotPoint& p) const {
    if (!p.noValue || plot.dial) return place(p.x, p.y);
    const int row = std::max(0, crossRows[std::size_t(series)]);
    return {left + (along(plot.x, p.x) - shown.x0) / (shown.x1 - shown.x0) * (right - left),
            top - px(0.6 * kCrossRow + row * kCrossRow)};
  }
  bool inside(const Eigen::Vector2d& p) const {
    constexpr double kSlack = 1;
    return p.allFinite() && (plot.dial || (p.x() >= left - kSlack && p.x() <= right + kSlack && p.y() >= bottom - kSlack &&
                                           p.y() <= top + kSlack));
  }

  const PlotPoint& pointOf(const PlotSample& sample) const {
    return plot.series[std::size_t(sample.series)].points[std::size_t(sample.point)];
  }
  /// The sample nearer to a place in the scene than `reach`; bars have none. @param model  only its samples; "" = all
  std::optional<PlotSample> nearest(const Eigen::Vector2d& scene, double reach, const std::string& model) const {
    std::optional<PlotSample> best;
    for (int s = 0; s < int(plot.series.size()); ++s) {
      const PlotSeries& series = plot.series[std::size_t(s)];
      if (series.shape == PlotShape::Bars) continue;
      for (int i = 0; i < int(series.points.size()); ++i) {
        const PlotPoint& p = series.points[std::size_t(i)];
        if (!model.empty() && p.target.model != model) continue;
        const Eigen::Vector2d at = placeOf(s, p);  // not finite for a gap
        if (!inside(at)) continue;
        const double distance = (at - scene).norm();
        if (distance < reach) reach = distance, best = PlotSample{s, i};
      }
    }
    return best;
  }

  void rebuild();
  void paintSeries(vtkContext2D* painter);
  void styleAxes();
  void layout(vtkContext2D* painter);
  double header(vtkContext2D* painter, bool draw);
  void paintOver(vtkContext2D* painter);
  void paintDial(vtkContext2D* painter);
  void paintBars(vtkContext2D* painter);
  void paintErrorBars(vtkContext2D* painter);
  void paintCrosses(vtkContext2D* painter);
  void paintMarks(vtkContext2D* painter);
  void ring(vtkContext2D* painter, const PlotSample& sample, double r, const Colour& colour, double width);
};

PlotView::PlotView() : impl_(std::make_unique<Impl>()) {
  Impl& d = *impl_;
  d.chart->SetLayoutStrategy(vtkChart::FILL_RECT);
  d.chart->SetInteractive(false);
  d.chart->SetShowLegend(false);
  d.chart->GetBackgroundBrush()->SetOpacityF(0);
  d.before->paint = [&d](vtkContext2D* painter) { d.layout(painter); };
  d.after->paint = [&d](vtkContext2D* painter) { d.paintOver(painter); };
  d.actor->GetScene()->AddItem(d.before);
  d.actor->GetScene()->AddItem(d.chart);
  d.actor->GetScene()->AddItem(d.after);
  d.renderer->AddActor(d.actor);
  d.actor->GetScene()->SetRenderer(d.renderer);
  d.rebuild();
}

PlotView::~PlotView() = default;
vtkRenderer* PlotView::renderer() const { return impl_->renderer; }
const PlotData& PlotView::plot() const { return impl_->plot; }

void PlotView::setStyle(const PlotStyle& style) {
  if (impl_->style == style) return;
  impl_->style = style;
  impl_->rebuild();
}

void PlotView::show(const PlotData& plot) {
  Impl& d = *impl_;
  const PlotRange range = rangeOf(plot);
  const bool same = plot.id == d.plot.id && range.x0 == d.whole.x0 && range.x1 == d.whole.x1;
  const bool keep = same && zoomed();
  d.plot = plot;
  d.whole = range;
  if (!keep) d.shown = range;
  d.hovered.reset();
  d.marked = selectedSamples(d.plot, d.selection);
  d.crossRows.clear();
  int rows = 0;
  for (const PlotSeries& series : d.plot.series) {
    const bool any = std::any_of(series.points.begin(), series.points.end(), [](const PlotPoint& p) { return p.noValue; });
    d.crossRows.push_back(any ? rows++ : -1);
  }
  d.rebuild();
}

void PlotView::setSelection(const Selection& selection) {
  impl_->selection = selection;
  impl_->marked = selectedSamples(impl_->plot, selection);
}

void PlotView::setHovered(const std::optional<PlotSample>& sample) { impl_->hovered = sample; }

void PlotView::Impl::rebuild() {
  const Colour& background = style.dark ? kDarkBackground : kLightBackground;
  renderer->SetBackground(background[0], background[1], background[2]);
  renderer->SetBackgroundAlpha(1);  // else an SVG has none
  chart->ClearPlots();
  chart->SetVisible(!isEmpty() && !plot.dial);
  painted = false;
  if (isEmpty() || plot.dial) return;
  // VTK lays out no chart without a plot. The series are painted in pixels instead (paintSeries): exported to SVG, VTK's own
  // lines are clipped in the data's coordinates and vanish in viewers that follow the standard.
  vtkNew<vtkTable> table;
  vtkNew<vtkDoubleArray> x, y;
  x->SetName("x");
  y->SetName("y");
  for (const double end : {0.0, 1.0}) {
    x->InsertNextValue(shown.x0 + end * (shown.x1 - shown.x0));
    y->InsertNextValue(shown.y0 + end * (shown.y1 - shown.y0));
  }
  table->AddColumn(x);
  table->AddColumn(y);
  auto* line = vtkPlotLine::SafeDownCast(chart->AddPlot(vtkChart::LINE));
  line->SetInputData(table, 0, 1);
  line->GetPen()->SetLineType(vtkPen::NO_PEN);
  styleAxes();
}

void PlotView::Impl::paintSeries(vtkContext2D* painter) {
  constexpr std::size_t kManyPoints = 500;  // ellipses one by one take too long; markers are squares where they are small
  int clip[4] = {int(std::floor(left)), int(std::floor(bottom)), int(std::ceil(right - left)) + 1,
                 int(std::ceil(top - bottom)) + 1};
  painter->GetDevice()->SetClipping(clip);
  painter->GetDevice()->EnableClipping(true);
  std::vector<float> run;
  for (const PlotSeries& series : plot.series) {
    if (series.shape == PlotShape::Bars) continue;
    const auto poly = [&](const Colour& colour, double width) {
      setPen(painter->GetPen(), colour, px(width));
      painter->GetPen()->SetLineType(lineType(series.dash));
      if (run.size() >= 4) painter->DrawPoly(run.data(), int(run.size() / 2));
    };
    for (const bool halo : {true, false}) {
      if (halo && !series.halo) continue;
      const Colour& colour = halo ? kHalo : series.colour;
      const double more = halo ? 2 : 0;
      run.clear();
      if (series.shape != PlotShape::Points) {
        for (const PlotPoint& p : series.points) {
          const Eigen::Vector2d at = place(p.x, p.y);
          if (at.allFinite()) {
            run.push_back(float(at.x()));
            run.push_back(float(at.y()));
            continue;
          }
          poly(colour, series.width + more);
          run.clear();
        }
        poly(colour, series.width + more);
      }
      run.clear();
      if (series.shape == PlotShape::Line) continue;
      for (const PlotPoint& p : series.points) {
        const Eigen::Vector2d at = place(p.x, p.y);
        if (!inside(at)) continue;
        run.push_back(float(at.x()));
        run.push_back(float(at.y()));
      }
      const double size = px(series.pointSize + more);
      if (run.size() / 2 > kManyPoints) {
        setPen(painter->GetPen(), colour, size);
        setBrush(painter, colour);
        painter->DrawMarkers(VTK_MARKER_CIRCLE, false, run.data(), int(run.size() / 2));
      } else {
        setPen(painter->GetPen(), colour, 0);
        setBrush(painter, colour);
        for (std::size_t i = 0; i + 1 < run.size(); i += 2)
          painter->DrawEllipse(run[i], run[i + 1], float(0.5 * size), float(0.5 * size));
      }
    }
  }
  painter->GetDevice()->EnableClipping(false);
}

void PlotView::Impl::styleAxes() {
  for (const int side : {vtkAxis::LEFT, vtkAxis::BOTTOM}) {
    vtkAxis* axis = chart->GetAxis(side);
    axis->SetTitle(side == vtkAxis::LEFT ? plot.y.title : plot.x.title);
    setText(axis->GetTitleProperties(), px(kFont), faded());
    setText(axis->GetLabelProperties(), px(kSmallFont), faded());
    setPen(axis->GetPen(), faded(), px(1));
    setPen(axis->GetGridPen(), grid(), px(1));
    axis->SetTickLength(float(px(4)));
    axis->SetLabelOffset(float(px(6)));
    axis->SetBehavior(vtkAxis::FIXED);
  }
  for (const int side : {vtkAxis::RIGHT, vtkAxis::TOP}) chart->GetAxis(side)->SetVisible(false);
  chart->SetHiddenAxisBorder(int(px(10)));
}

double PlotView::Impl::header(vtkContext2D* painter, bool draw) {
  return paintPlotHeader(painter, plot, {text(), faded(), style.scale, style.dark}, actor->GetScene()->GetSceneWidth(),
                         actor->GetScene()->GetSceneHeight(), !isEmpty(), draw);
}

void PlotView::Impl::layout(vtkContext2D* painter) {
  const double width = actor->GetScene()->GetSceneWidth(), height = actor->GetScene()->GetSceneHeight();
  sceneHeight = height;
  const double head = header(painter, false);
  if (isEmpty()) return;
  if (plot.dial) {
    const double room = height - head;
    centre = {0.5 * width, 0.5 * room};
    radius = std::max(px(10), 0.5 * std::min(width, room) - px(16));
    painted = true;
    return;
  }
  chart->SetSize(vtkRectf(0, 0, float(width), float(std::max(px(40), height - head))));
  const double range[2][2] = {{shown.x0, shown.x1}, {shown.y0, shown.y1}};
  const int most[2] = {std::max(2, int(width / px(75))), std::max(2, int((height - head) / px(36)))};
  for (const int side : {vtkAxis::BOTTOM, vtkAxis::LEFT}) {
    const int k = side == vtkAxis::BOTTOM ? 0 : 1;
    vtkAxis* axis = chart->GetAxis(side);
    axis->SetRange(range[k][0], range[k][1]);
    vtkNew<vtkDoubleArray> positions;
    vtkNew<vtkStringArray> labels;
    for (const auto& [position, label] : ticksOf(k == 0 ? plot.x : plot.y, range[k][0], range[k][1], most[k])) {
      positions->InsertNextValue(position);
      labels->InsertNextValue(label);
    }
    axis->SetCustomTickPositions(positions, labels);
    // VTK centres the title on the axis, which leaves room for what is written beside it on one side only.
    const double room = k == 0 ? width - px(60) : height - head - px(35);
    setPainterText(painter, px(kFont), faded());
    axis->SetTitle(fitting(k == 0 ? plot.x.title : plot.y.title, [&](const std::string& s) {
      float box[4];
      painter->ComputeStringBounds(s, box);
      return double(box[2]) <= room;
    }));
  }
}

void PlotView::Impl::paintOver(vtkContext2D* painter) {
  header(painter, true);
  const double width = actor->GetScene()->GetSceneWidth();
  if (isEmpty()) {
    setPainterText(painter, px(kFont), faded());
    painter->GetTextProp()->SetJustificationToCentered();
    const std::string words = plot.empty.empty() ? "Nothing to show" : plot.empty;
    painter->DrawString(float(0.5 * width), float(0.5 * sceneHeight), wrapped(words, std::max(12, int(width / px(7.5)) - 4)));
    return;
  }
  if (plot.dial) {
    paintDial(painter);
  } else {
    vtkAxis *bottomAxis = chart->GetAxis(vtkAxis::BOTTOM), *leftAxis = chart->GetAxis(vtkAxis::LEFT);
    left = bottomAxis->GetPoint1()[0];
    right = bottomAxis->GetPoint2()[0];
    bottom = leftAxis->GetPoint1()[1];
    top = leftAxis->GetPoint2()[1];
    painted = right > left && top > bottom;
    if (!painted) return;
    setPen(painter->GetPen(), text(), 0);
    for (const PlotShade& shade : plot.shades) {
      const double a = std::clamp(place(shade.from, 1).x(), left, right), b = std::clamp(place(shade.to, 1).x(), left, right);
      setBrush(painter, shade.colour, shadeOpacity(style.dark));
      if (b > a) painter->DrawRect(float(a), float(bottom), float(b - a), float(top - bottom));
    }
    paintBars(painter);
    paintSeries(painter);
    paintErrorBars(painter);
    paintCrosses(painter);
  }
  paintMarks(painter);
}

void PlotView::Impl::paintBars(vtkContext2D* painter) {
  bool any = false;
  for (const PlotSeries& series : plot.series) {
    if (series.shape != PlotShape::Bars) continue;
    any = true;
    setPen(painter->GetPen(), text(), 0);
    setBrush(painter, series.colour);
    for (const PlotPoint& p : series.points) {
      if (!std::isfinite(p.y)) continue;
      const Eigen::Vector2d a = place(p.x - 0.5 * series.barWidth, plot.y.log ? plot.y.floor : 0),
                            b = place(p.x + 0.5 * series.barWidth, p.y);
      const double x0 = std::clamp(a.x(), left, right), x1 = std::clamp(b.x(), left, right);
      double y0 = std::clamp(std::min(a.y(), b.y()), bottom, top), y1 = std::clamp(std::max(a.y(), b.y()), bottom, top);
      if (y1 - y0 < px(1.5)) y1 = y0 + px(1.5);  // a bar of nothing is still a sample
      if (x1 > x0) painter->DrawRect(float(x0), float(y0), float(x1 - x0), float(y1 - y0));
    }
  }
  const double zero = place(0, 0).y();
  if (any && !plot.y.log && zero > bottom && zero < top) {
    setPen(painter->GetPen(), faded(), px(1));
    painter->DrawLine(float(left), float(zero), float(right), float(zero));
  }
}

void PlotView::Impl::paintErrorBars(vtkContext2D* painter) {
  for (const PlotSeries& series : plot.series)
    for (const PlotPoint& p : series.points) {
      if (!p.band || !std::isfinite(p.y)) continue;
      const Eigen::Vector2d low = place(p.x, p.band->first), high = place(p.x, p.band->second);
      if (!(low.x() >= left && low.x() <= right)) continue;
      const double y0 = std::clamp(low.y(), bottom, top), y1 = std::clamp(high.y(), bottom, top), cap = px(4);
      setPen(painter->GetPen(), series.colour, px(1.5));
      painter->DrawLine(float(low.x()), float(y0), float(low.x()), float(y1));
      for (const double y : {y0, y1}) painter->DrawLine(float(low.x() - cap), float(y), float(low.x() + cap), float(y));
    }
}

/// Of several models side by side, each in a row of its own: none hides another.
void PlotView::Impl::paintCrosses(vtkContext2D* painter) {
  for (int s = 0; s < int(plot.series.size()); ++s)
    for (const PlotPoint& p : plot.series[std::size_t(s)].points)
      if (const Eigen::Vector2d at = placeOf(s, p); p.noValue && inside(at))
        paintCross(painter, at, px(kCross), plot.series[std::size_t(s)].colour, style.dark ? kHalo : Colour{1, 1, 1}, px(1.75));
}

void PlotView::Impl::paintDial(vtkContext2D* painter) {
  const double largest = plot.y.to.value_or(1);
  setBrush(painter, text(), 0);  // arcs would be filled
  const auto circle = [&](double value, const Colour& colour, double width) {
    setPen(painter->GetPen(), colour, px(width));
    painter->DrawArc(float(centre.x()), float(centre.y()), float(radius * (kZeroRadius + kReachOfDial * value / largest)), 0,
                     360);
  };
  setPen(painter->GetPen(), grid(), px(1));
  for (int i = 0; i < 8; ++i) {
    const Eigen::Vector2d d(std::cos(i * std::numbers::pi / 4), std::sin(i * std::numbers::pi / 4)),
        a = centre + 0.15 * radius * d, b = centre + radius * d;
    painter->DrawLine(float(a.x()), float(a.y()), float(b.x()), float(b.y()));
  }
  const auto ticks = dialTicks(plot.y, largest);
  for (const auto& [value, label] : ticks)
    for (const double v : {value, -value}) circle(v, grid(), 1);
  circle(0, kHalo, 3.5);
  circle(0, kObserved, 1.75);
  for (const PlotSeries& series : plot.series) {
    const std::size_t n = series.points.size();
    setPen(painter->GetPen(), series.colour, px(series.width));
    for (std::size_t i = 0; i < n; ++i) {
      const PlotPoint &p = series.points[i], &q = series.points[(i + 1) % n];
      if (!std::isfinite(p.y) || !std::isfinite(q.y)) continue;
      const Eigen::Vector2d a = place(p.x, p.y), b = place(q.x, q.y);
      painter->DrawLine(float(a.x()), float(a.y()), float(b.x()), float(b.y()));
    }
  }
  setPainterText(painter, px(kSmallFont), faded());
  const struct {
    const char* text;
    double x, y;
  } names[] = {{"right", 1, 0}, {"left", -1, 0}, {"up", 0, 1}, {"down", 0, -1}};
  for (const auto& n : names) {
    painter->GetTextProp()->SetJustification(n.x > 0 ? VTK_TEXT_LEFT : n.x < 0 ? VTK_TEXT_RIGHT : VTK_TEXT_CENTERED);
    const Eigen::Vector2d at = centre + (radius + px(n.x != 0 ? 4 : 8)) * Eigen::Vector2d(n.x, n.y);
    painter->DrawString(float(at.x()), float(at.y()), n.text);
  }
  painter->GetTextProp()->SetJustificationToCentered();
  const Eigen::Vector2d slanted(std::cos(3 * std::numbers::pi / 8), std::sin(3 * std::numbers::pi / 8));
  for (const auto& [value, label] : ticks)
    for (const double v : {value, -value}) {
      const Eigen::Vector2d at = centre + radius * (kZeroRadius + kReachOfDial * v / largest) * slanted;
      painter->DrawString(float(at.x()), float(at.y()), (v > 0 ? "+" : "-") + label);
    }
  painter->DrawString(float(centre.x()), float(centre.y()), "px");
}

void PlotView::Impl::ring(vtkContext2D* painter, const PlotSample& sample, double r, const Colour& colour, double width) {
  if (sample.series < 0 || sample.series >= int(plot.series.size())) return;
  const PlotSeries& series = plot.series[std::size_t(sample.series)];
  if (sample.point < 0 || sample.point >= int(series.points.size())) return;
  const Eigen::Vector2d at = placeOf(sample.series, series.points[std::size_t(sample.point)]);
  if (!inside(at)) return;
  setBrush(painter, colour, 0);
  setPen(painter->GetPen(), style.dark ? kHalo : Colour{1, 1, 1}, px(width + 2));
  painter->DrawArc(float(at.x()), float(at.y()), float(px(r)), 0, 360);
  setPen(painter->GetPen(), colour, px(width));
  painter->DrawArc(float(at.x()), float(at.y()), float(px(r)), 0, 360);
}

void PlotView::Impl::paintMarks(vtkContext2D* painter) {
  constexpr std::size_t kMany = 24;  // rings around so many pixels are smaller
  double last = std::numeric_limits<double>::quiet_NaN();
  for (const PlotSample& m : marked) {
    const PlotPoint& p = plot.series[std::size_t(m.series)].points[std::size_t(m.point)];
    if (plot.dial || p.x == last || marked.size() > kMany || (p.target.frame < 0 && !p.target.direction)) continue;
    if (plot.series[std::size_t(m.series)].shape == PlotShape::Points) continue;
    last = p.x;
    const double x = place(p.x, p.y).x();
    if (x < left || x > right) continue;
    setPen(painter->GetPen(), kActiveView, px(1.5), 0.8);
    painter->DrawLine(float(x), float(bottom), float(x), float(top));
  }
  for (const PlotSample& m : marked)
    ring(painter, m, marked.size() > kMany ? 3 : 6, style.dark ? Colour{1, 1, 1} : kActiveView, marked.size() > kMany ? 1 : 1.75);
  if (hovered) ring(painter, *hovered, 5, style.dark ? kLightColour : kHalo, 1.5);
}

std::optional<Eigen::Vector2d> PlotView::positionOf(const PlotSample& sample) const {
  const Impl& d = *impl_;
  if (!d.painted || sample.series < 0 || sample.series >= int(d.plot.series.size())) return std::nullopt;
  const std::vector<PlotPoint>& points = d.plot.series[std::size_t(sample.series)].points;
  if (sample.point < 0 || sample.point >= int(points.size())) return std::nullopt;
  const Eigen::Vector2d at = d.placeOf(sample.series, points[std::size_t(sample.point)]);  // not finite for a gap
  if (!d.inside(at)) return std::nullopt;
  return Eigen::Vector2d(at.x(), d.sceneHeight - at.y());
}

std::optional<PlotSample> PlotView::at(const Eigen::Vector2d& place, double reach) const {
  const Impl& d = *impl_;
  if (!d.painted || d.isEmpty()) return std::nullopt;
  const Eigen::Vector2d scene(place.x(), d.sceneHeight - place.y());
  for (int s = 0; s < int(d.plot.series.size()); ++s) {
    const PlotSeries& series = d.plot.series[std::size_t(s)];
    if (series.shape != PlotShape::Bars) continue;
    for (int i = 0; i < int(series.points.size()); ++i) {
      const double x = series.points[std::size_t(i)].x;
      const double x0 = d.place(x - 0.5 * series.barWidth, 1).x(), x1 = d.place(x + 0.5 * series.barWidth, 1).x();
      if (scene.x() >= x0 && scene.x() < x1 && scene.y() >= d.bottom && scene.y() <= d.top) return PlotSample{s, i};
    }
  }
  const std::optional<PlotSample> best = d.nearest(scene, reach, "");
  if (!best || d.selection.model.empty() || d.pointOf(*best).target.model == d.selection.model) return best;
  // Where points lie on one another the selected model stays, whichever of them is drawn on top.
  const std::optional<PlotSample> own =
      d.nearest(d.placeOf(best->series, d.pointOf(*best)), kCoincides * reach, d.selection.model);
  return own ? own : best;
}

void PlotView::zoom(double factor, const Eigen::Vector2d& about, bool both) {
  Impl& d = *impl_;
  if (!d.painted || d.plot.dial || !(factor > 0)) return;
  const double fx = std::clamp((about.x() - d.left) / (d.right - d.left), 0.0, 1.0);
  const double fy = std::clamp((d.sceneHeight - about.y() - d.bottom) / (d.top - d.bottom), 0.0, 1.0);
  const auto change = [factor](double& a, double& b, double at, double low, double high) {
    const double middle = a + at * (b - a), width = std::min((b - a) / factor, high - low);
    a = std::clamp(middle - at * width, low, high - width);
    b = a + width;
  };
  change(d.shown.x0, d.shown.x1, fx, d.whole.x0, d.whole.x1);
  if (both) change(d.shown.y0, d.shown.y1, fy, d.whole.y0, d.whole.y1);
}

void PlotView::pan(const Eigen::Vector2d& by) {
  Impl& d = *impl_;
  if (!d.painted || d.plot.dial) return;
  const auto move = [](double& a, double& b, double distance, double low, double high) {
    const double allowed = std::clamp(distance, low - a, high - b);
    a += allowed;
    b += allowed;
  };
  move(d.shown.x0, d.shown.x1, -by.x() / (d.right - d.left) * (d.shown.x1 - d.shown.x0), d.whole.x0, d.whole.x1);
  move(d.shown.y0, d.shown.y1, by.y() / (d.top - d.bottom) * (d.shown.y1 - d.shown.y0), d.whole.y0, d.whole.y1);
}

void PlotView::showAll() { impl_->shown = impl_->whole; }

bool PlotView::zoomed() const {
  const PlotRange &a = impl_->shown, &b = impl_->whole;
  return a.x0 != b.x0 || a.x1 != b.x1 || a.y0 != b.y0 || a.y1 != b.y1;
}

}  // namespace glint::viz
