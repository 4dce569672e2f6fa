// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <cmath>

#include "core/draw/plot_view.h"
#include "core/draw/scatter_plot.h"

namespace glint::draw {
namespace scatter_tests {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

HighlightRow row(int frame, RowStatus status, double x, double y, const std::string& model = "dual") {
  HighlightRow r;
  r.frame = frame;
  r.observed = 0;
  r.model = model;
  r.light = r.place = "lamp";
  r.status = status;
  r.values.fill(std::nan(""));
  r.values[std::size_t(RowValue::IncidentDeg)] = x;
  r.values[std::size_t(RowValue::ErrorPct)] = y;
  return r;
}

const double kNone = std::nan("");

std::vector<HighlightRow> sample() {
  return {row(0, RowStatus::Ok, 10, 1),         row(1, RowStatus::Poor, 20, 30),
          row(2, RowStatus::Missed, 30, kNone), row(3, RowStatus::Refused, kNone, kNone),
          row(4, RowStatus::Ok, 40, 0),         row(5, RowStatus::Ok, 50, 2, "primal")};
}

TEST(ScatterPlot, WhatHasNoValueIsCountedAndNotDrawn) {
  const std::vector<HighlightRow> rows = sample();
  const ScatterPlot s = scatterPlot(Inspection{}, rows, {});
  EXPECT_THAT(s.plot.remarks, ElementsAre("4 of 6 highlights", "no value: 1 missed, 1 refused"));
  int drawn = 0, all = 0;
  for (std::size_t i = 0; i < s.plot.series.size(); ++i)
    for (std::size_t p = 0; p < s.plot.series[i].points.size(); ++p, ++all) {
      const PlotPoint& point = s.plot.series[i].points[p];
      const HighlightRow& r = rows[std::size_t(s.rowOf({int(i), int(p)}))];
      EXPECT_EQ(point.target.frame, r.frame);
      drawn += std::isfinite(point.x) && std::isfinite(point.y);
      if (std::isnan(r.value(RowValue::ErrorPct))) {
        EXPECT_TRUE(std::isnan(point.y)) << r.frame;
      }
    }
  EXPECT_EQ(drawn, 4);
  EXPECT_EQ(all, 6);
  EXPECT_THAT(plotCsv(s.plot), HasSubstr("\"no value\",,,"));
  EXPECT_EQ(s.rowOf({0, 99}), -1);
  EXPECT_EQ(s.rowOf({-1, 0}), -1);
  const PlotRange range = rangeOf(s.plot);
  EXPECT_GT(range.x0, 5) << "nothing at 0 widens the range";
}

TEST(ScatterPlot, ALogarithmicAxisDoesNotShowWhatIsNotPositive) {
  ScatterOptions options;
  options.logY = true;
  const ScatterPlot s = scatterPlot(Inspection{}, sample(), options);
  EXPECT_THAT(s.plot.remarks, Contains("1 not above 0, which a logarithmic axis cannot show"));
  EXPECT_THAT(s.plot.remarks, Contains("3 of 6 highlights"));
  const PlotRange range = rangeOf(s.plot);
  EXPECT_NEAR(range.y0, 0, 0.2);  // log10 of 1 .. 30
  EXPECT_NEAR(range.y1, std::log10(30), 0.2);
}

TEST(ScatterPlot, ColoursTellClassesApart) {
  const auto names = [](const ScatterPlot& s) {
    std::vector<std::string> all;
    for (const PlotSeries& series : s.plot.series)
      if (series.inLegend) all.push_back(series.name);
    return all;
  };
  ScatterOptions options;
  EXPECT_THAT(names(scatterPlot(Inspection{}, sample(), options)), ElementsAre("dual", "primal"));
  options.colour = ScatterColour::Status;
  EXPECT_THAT(names(scatterPlot(Inspection{}, sample(), options)), ElementsAre("ok", "poor"));
  options.colour = ScatterColour::Light;
  EXPECT_THAT(names(scatterPlot(Inspection{}, sample(), options)), ElementsAre("light lamp"));
}

TEST(ScatterPlot, WhatIsNotBrushedIsGrey) {
  const std::vector<HighlightRow> rows = sample();
  ScatterOptions options;
  options.brushed = {keyOf(rows[1]), keyOf(rows[2])};
  const ScatterPlot s = scatterPlot(Inspection{}, rows, options);
  EXPECT_THAT(s.plot.remarks, Contains("2 brushed"));
  for (std::size_t i = 0; i < s.plot.series.size(); ++i)
    for (const int r : s.rows[i])
      if (s.plot.series[i].name != "no value") {
        EXPECT_EQ(s.plot.series[i].name == "not brushed", r != 1) << r;
      }
}

TEST(ScatterPlot, NothingIsSaidInWords) {
  EXPECT_EQ(scatterPlot(Inspection{}, {}, {}).plot.empty, "No results yet");
  const ScatterPlot none = scatterPlot(Inspection{}, {row(0, RowStatus::Missed, 1, kNone)}, {});
  EXPECT_EQ(none.plot.empty, "No highlight has both values");
}

}  // namespace scatter_tests
}  // namespace glint::draw
