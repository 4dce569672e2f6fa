// SPDX-License-Identifier: BSD-3-Clause
#include "viz/plots/plot_header.h"

#include <vtkBrush.h>
#include <vtkContext2D.h>
#include <vtkPen.h>
#include <vtkStdString.h>

#include <algorithm>
#include <functional>
#include <string>
#include <vector>

#include "viz/plots/painting.h"

namespace glint::viz {
namespace {

constexpr double kHeaderFont = 12, kHeaderSmallFont = 11;        // screen px
constexpr double kLine = 18;                         // height of a line, screen px
constexpr double kLeastPlot = 100, kLeastDial = 90;  // height that the legend leaves to a plot with its axes, screen px
constexpr double kSwatch = 18;                       // width of what stands before a name, screen px
constexpr Colour kHeaderHalo{0.12, 0.13, 0.15};

/// One entry of the legend: what is drawn about the middle of its swatch, and its name.
struct Entry {
  std::string name;
  std::function<void(double x, double y)> paint;
};

bool hasCrosses(const PlotData& plot) {
  for (const PlotSeries& series : plot.series)
    for (const PlotPoint& p : series.points)
      if (p.noValue) return true;
  return false;
}

}  // namespace

double shadeOpacity(bool dark) { return dark ? 0.30 : 0.16; }

void paintCross(vtkContext2D* painter, const Eigen::Vector2d& at, double half, const Colour& colour, const Colour& around,
                double width) {
  for (const bool outer : {true, false}) {
    setPen(painter->GetPen(), outer ? around : colour, outer ? 2.2 * width : width);
    const double r = outer ? half + 0.6 * width : half;
    painter->DrawLine(float(at.x() - r), float(at.y() - r), float(at.x() + r), float(at.y() + r));
    painter->DrawLine(float(at.x() - r), float(at.y() + r), float(at.x() + r), float(at.y() - r));
  }
}

double paintPlotHeader(vtkContext2D* painter, const PlotData& plot, const PlotHeaderStyle& style, double width, double height,
                       bool legend, bool draw) {
  const auto px = [&](double screen) { return screen * style.scale; };
  const double lineHeight = px(kLine), margin = px(8), swatch = px(kSwatch);
  double y = height - 0.5 * lineHeight - px(2), x = margin;
  setPainterText(painter, px(kHeaderFont), style.text, true);
  const auto widthOf = [&](const std::string& s) {
    float box[4];
    painter->ComputeStringBounds(s, box);
    return double(box[2]);
  };
  if (draw) painter->DrawString(float(x), float(y), plot.title);
  x += widthOf(plot.title) + px(18);
  setPainterText(painter, px(kHeaderSmallFont), style.text);

  std::vector<Entry> entries;
  for (const PlotSeries& series : plot.series) {
    if (!series.inLegend) continue;
    entries.push_back({series.name, [&, swatch](double left, double middle) {
                         const bool line = series.shape == PlotShape::Line || series.shape == PlotShape::LineAndPoints;
                         for (const bool halo : {true, false}) {
                           if (halo && !series.halo) continue;
                           const Colour& colour = halo ? kHeaderHalo : series.colour;
                           const double more = halo ? px(2) : 0;
                           if (line) {
                             setPen(painter->GetPen(), colour, px(std::max(2.0, series.width)) + more);
                             if (!halo) painter->GetPen()->SetLineType(lineType(series.dash));
                             painter->DrawLine(float(left), float(middle), float(left + swatch), float(middle));
                             continue;
                           }
                           setPen(painter->GetPen(), colour, 0);
                           setBrush(painter, colour);
                           const bool bar = series.shape == PlotShape::Bars;
                           const double r = (bar ? px(5) : std::max(px(3), 0.5 * px(series.pointSize))) + 0.5 * more;
                           if (bar)
                             painter->DrawRect(float(left + 0.5 * swatch - r), float(middle - r), float(2 * r), float(2 * r));
                           else
                             painter->DrawEllipse(float(left + 0.5 * swatch), float(middle), float(r), float(r));
                         }
                       }});
  }
  if (!plot.noValue.empty() && hasCrosses(plot))
    entries.push_back({plot.noValue, [&, swatch](double left, double middle) {
                         paintCross(painter, {left + 0.5 * swatch, middle}, px(3.5), style.faded,
                                    style.dark ? kHeaderHalo : Colour{1, 1, 1}, px(1.75));
                       }});
  std::vector<std::string> named;
  for (const PlotShade& shade : plot.shades) {
    if (shade.name.empty() || std::find(named.begin(), named.end(), shade.name) != named.end()) continue;
    named.push_back(shade.name);
    entries.push_back({shade.name, [&, swatch](double left, double middle) {
                         setPen(painter->GetPen(), shade.colour, px(1));
                         setBrush(painter, shade.colour, 1.5 * shadeOpacity(style.dark));
                         painter->DrawRect(float(left + px(3)), float(middle - px(5)), float(swatch - px(6)), float(px(10)));
                       }});
  }

  const double lowest = px(plot.dial ? kLeastDial : kLeastPlot) + 0.5 * lineHeight;
  for (const Entry& entry : legend ? entries : std::vector<Entry>{}) {
    const double needed = swatch + px(5) + widthOf(entry.name) + px(14);
    if (x + needed > width - margin && x > margin) {
      if (y - lineHeight < lowest) {
        if (draw) painter->DrawString(float(std::min(x, width - margin - widthOf("\u2026"))), float(y), "\u2026");
        break;
      }
      x = margin, y -= lineHeight;
    }
    if (draw) {
      entry.paint(x, y);
      painter->DrawString(float(x + swatch + px(5)), float(y), entry.name);
    }
    x += needed;
  }
  return height - y + 0.5 * lineHeight;
}

}  // namespace glint::viz
