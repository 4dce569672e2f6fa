// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/draw/colours.h"
#include "core/draw/painter.h"
#include "core/draw/selection.h"

namespace glint::draw {

/// What a sample of a plot stands for; fields that do not apply stay as they are.
struct PlotTarget {
  int frame = -1;
  std::string model, light;
  int highlight = -1;
  std::optional<double> direction;  ///< Selection::direction
  int setting = -1;                 ///< index into Tradeoff::points
};

struct PlotPoint {
  double x = 0, y = 0;   ///< in the axes' units, even if an axis is logarithmic; y NaN = a gap in the line
  bool noValue = false;  ///< y is NaN, and that is to be seen: a cross at the top of the plot, see PlotData::noValue
  std::optional<std::pair<double, double>> band;  ///< lower and upper end of the error bar
  std::string label;                              ///< lines for a tool tip
  std::string note{};                             ///< beside the sample, which has a ring around it; "" = none
  bool hollow = false;                            ///< a ring in place of a disc
  bool triangle = false;                          ///< a triangle around it, see PlotData::triangles
  PlotTarget target;
};

enum class PlotShape { Line, Points, LineAndPoints, Bars };

struct PlotSeries {
  std::string name;
  Colour colour{1, 1, 1};
  PlotShape shape = PlotShape::Line;
  Dash dash = Dash::Solid;
  double width = 2;       ///< screen px
  double pointSize = 6;   ///< screen px
  double barWidth = 0.8;  ///< in units of x
  bool halo = false;      ///< a dark stroke beneath: the observed series, which is white in both themes
  bool inLegend = true;
  double markReach = 0.05;  ///< rad: samples this near to the selected direction are marked, or the nearest one where none is
  std::vector<PlotPoint> points;
};

struct PlotAxis {
  std::string title;  ///< with the unit in brackets
  bool log = false;   ///< values <= 0 are drawn at `floor`
  double floor = 1e-6;
  std::optional<double> from, to;                       ///< else the data's range with a margin
  std::vector<std::pair<double, std::string>> names{};  ///< instead of numbers: (position, text)
  bool counts = false;                                  ///< whole numbers from 0, as frames: no tick between them, none below 0
};

/// A range of x that is tinted over the whole height: the training frames, the excluded ones.
struct PlotShade {
  double from = 0, to = 0;
  Colour colour{};
  std::string name{};  ///< for the legend, which says the same name once; "" = not there
};

/// One plot: all its content, without its look. Plain data.
struct PlotData {
  std::string id;  ///< "error", "lobe", ...
  std::string title;
  std::string empty;  ///< one sentence in place of a missing plot
  /// y by direction x (rad) around a circle, 0 = right and pi/2 = down as in the photograph; the circle is y = 0.
  bool dial = false;
  PlotAxis x, y;
  std::vector<PlotSeries> series;
  std::vector<PlotShade> shades;
  std::vector<std::string> remarks{};  ///< precede the legend: how many samples there are, what is not shown
  std::string noValue;                 ///< what the crosses at the top stand for, for the legend: "missed highlight"
  std::string triangles{};             ///< the same of triangles: "spurious highlight"
};

/// A sample: which series, which point.
struct PlotSample {
  int series = -1, point = -1;
  friend bool operator==(const PlotSample&, const PlotSample&) = default;
};

/// The samples that show the selection: those of the selected frame (model, light, highlight where both say one), and of the
/// selected direction.
std::vector<PlotSample> selectedSamples(const PlotData& plot, const Selection& selection);

/// The selection after a click on a sample: `before` with what the sample stands for. A sample of another frame drops highlight
/// and direction.
Selection selectionOf(const PlotTarget& target, Selection before);

/// Where a value is drawn along a logarithmic or plain axis: its decimal logarithm (of at least the floor), or itself.
double along(const PlotAxis& axis, double value);

/// Range of a plot along its axes (logarithms where an axis is logarithmic), error bars included, with a margin; never empty.
struct PlotRange {
  double x0 = 0, x1 = 1, y0 = 0, y1 = 1;
};
PlotRange rangeOf(const PlotData& plot);

/// Positions (as `along`) and texts of at most about `most` ticks in [from, to].
std::vector<std::pair<double, std::string>> ticksOf(const PlotAxis& axis, double from, double to, int most);
/// Values of a dial's circles in (0, largest]: about two, at least one. @param largest  > 0.
std::vector<std::pair<double, std::string>> dialTicks(const PlotAxis& axis, double largest);

/// The title of an axis; where that is too long, as many of its last words and its unit as fit: the unit stays longest. "" where
/// not even that fits, or there is no unit.
std::string fitting(const std::string& title, const std::function<bool(const std::string&)>& fits);

/// Comma-separated values: series, x, y, lower, upper, frame, model, light, highlight, direction, label; a first line names the
/// columns.
std::string plotCsv(const PlotData& plot);

/// True when positive values among these span more than a factor of 30: then a plain axis hides the small ones.
bool needsLogAxis(const std::vector<double>& values);

}  // namespace glint::draw
