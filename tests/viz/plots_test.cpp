// SPDX-License-Identifier: BSD-3-Clause
#include "core/draw/plots.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <numbers>
#include <set>
#include <sstream>

#include "core/base/atomic_file.h"
#include "core/draw/frame_overlay.h"
#include "core/draw/plot_view.h"
#include "core/draw/scatter_plot.h"
#include "tests/viz/small_inspection.h"
#include "viz/canvas.h"
#include "viz/plot_export.h"

namespace glint::viz {
namespace {

using test::smallInspection;
using test::TemporaryFolder;
using testing::HasSubstr;

constexpr double kRadiusPx = 14;  // of the contours in smallInspection; predicted ones are 1 px larger

PlotData line(std::vector<std::pair<double, double>> values) {
  PlotData plot;
  plot.id = "error";
  plot.title = "A line";
  PlotSeries series;
  series.name = "canonical";
  series.colour = modelColour("canonical");
  series.shape = PlotShape::Points;
  series.pointSize = 9;
  for (std::size_t i = 0; i < values.size(); ++i) {
    PlotPoint p;
    p.x = values[i].first;
    p.y = values[i].second;
    p.target.frame = int(i);
    p.target.model = "canonical";
    series.points.push_back(p);
  }
  plot.series = {series};
  return plot;
}

TEST(PlotData, AxesAreLogarithmicBeyondAFactorOfThirty) {
  EXPECT_FALSE(needsLogAxis({1, 29}));
  EXPECT_TRUE(needsLogAxis({1, 31}));
  EXPECT_FALSE(needsLogAxis({0, 0, 5, -3, std::nan("")})) << "only positive values have a ratio";
  EXPECT_FALSE(needsLogAxis({}));
  PlotAxis log;
  log.log = true;
  log.floor = 1e-3;
  EXPECT_NEAR(along(log, 100), 2, 1e-12);
  EXPECT_NEAR(along(log, 0), -3, 1e-12);
}

TEST(PlotData, Ticks) {
  const auto texts = [](const std::vector<std::pair<double, std::string>>& ticks) {
    std::string all;
    for (const auto& [at, text] : ticks) all += text + " ";
    return all;
  };
  EXPECT_EQ(texts(ticksOf({}, 0, 1, 5)), "0 0.2 0.4 0.6 0.8 1 ");
  EXPECT_EQ(texts(ticksOf({}, -1, 11, 4)), "0 5 10 ");
  EXPECT_EQ(texts(ticksOf({}, -0.5, 2.5, 6)), "-0.5 0 0.5 1 1.5 2 2.5 ");
  PlotAxis frames;
  frames.counts = true;
  EXPECT_EQ(texts(ticksOf(frames, -0.5, 2.5, 6)), "0 1 2 ") << "there is no frame half-way, and none before the first";
  PlotAxis log;
  log.log = true;
  EXPECT_EQ(texts(ticksOf(log, -2, 2, 6)), "0.01 0.1 1 10 100 ");
  EXPECT_EQ(texts(ticksOf(log, -12, 0, 4)), "1e-12 1e-08 0.0001 1 ");
  PlotAxis named;
  named.names = {{0, "a"}, {1, "b"}, {2, "c"}, {3, "d"}};
  EXPECT_EQ(texts(ticksOf(named, -1, 4, 2)), "a c ");
  EXPECT_TRUE(ticksOf({}, 1, 1, 5).empty());
}

/// A number whose unit is nowhere cannot be read; what it is of stands in the plot's title, too.
TEST(PlotData, TheUnitIsTheLastThingThatAShortTitleLoses) {
  const auto within = [](const std::string& title, std::size_t letters) {
    return fitting(title, [&](const std::string& s) { return s.size() <= letters; });
  };
  EXPECT_EQ(within("contour error (%)", 17), "contour error (%)");
  EXPECT_EQ(within("contour error (%)", 16), "error (%)");
  EXPECT_EQ(within("contour error (%)", 8), "(%)");
  EXPECT_EQ(within("contour error (%)", 2), "");
  EXPECT_EQ(within("semi-axis (m; lowest = 0, flat)", 22), "(m; lowest = 0, flat)");
  EXPECT_EQ(within("semi-axis (m; lowest = 0, flat)", 12), "(m)");
  EXPECT_EQ(within("relative to the first", 12), "");
}

TEST(PlotData, RangeTakesErrorBarsAndIgnoresGaps) {
  PlotData plot = line({{0, 1}, {10, std::nan("")}, {4, 3}});
  plot.series[0].points[2].band = {{2.0, 5.0}};
  const PlotRange r = rangeOf(plot);
  EXPECT_LT(r.x1, 5);
  EXPECT_GT(r.y1, 5);
  EXPECT_GT(rangeOf(PlotData{}).x1, rangeOf(PlotData{}).x0);
}

TEST(PlotData, SelectionAndSamplesAreLinkedBothWays) {
  PlotData plot = line({{0, 1}, {1, 2}, {2, 3}});
  Selection s;
  s.frame = 1;
  EXPECT_EQ(selectedSamples(plot, s), (std::vector<PlotSample>{{0, 1}}));
  s.model = "dual";
  EXPECT_TRUE(selectedSamples(plot, s).empty());
  const Selection clicked = selectionOf(plot.series[0].points[2].target, s);
  EXPECT_EQ(clicked.frame, 2);
  EXPECT_EQ(clicked.model, "canonical");
  s.direction = 1.0;
  s.highlight = 0;
  EXPECT_FALSE(selectionOf(plot.series[0].points[2].target, s).direction) << "another frame has other contours";
  PlotTarget direction{1, "dual", "lamp", 0, -3.0, -1};
  EXPECT_EQ(*selectionOf(direction, s).direction, -3.0);
  // Directions close over pi, and the nearest one is marked where none is near.
  for (PlotPoint& p : plot.series[0].points) p.target = {1, "", "", 0, 0.0, -1};
  plot.series[0].points[0].target.direction = std::numbers::pi;
  plot.series[0].points[1].target.direction = 2.0;
  plot.series[0].points[2].target.direction = 0.0;
  s.model.clear();
  s.direction = -std::numbers::pi + 0.01;
  EXPECT_EQ(selectedSamples(plot, s), (std::vector<PlotSample>{{0, 0}}));
  s.direction = 2.1;
  EXPECT_EQ(selectedSamples(plot, s), (std::vector<PlotSample>{{0, 1}}));
  s.direction = -1.5;
  EXPECT_TRUE(selectedSamples(plot, s).empty());
  s.direction.reset();
  EXPECT_TRUE(selectedSamples(plot, s).empty());
}

TEST(PlotData, CsvHasOneLinePerSample) {
  PlotData plot = line({{0, 1.5}, {1, std::nan("")}});
  plot.y.title = "error (%)";
  plot.series[0].name = "a \"quoted\", name";
  plot.series[0].points[0].target.direction = 0.25;
  EXPECT_EQ(plotCsv(plot),
            "series,\"\",\"error (%)\",lower,upper,index,model,light,highlight,direction,label\n"
            "\"a \"\"quoted\"\", name\",0,1.5,,,0,\"canonical\",\"\",,0.25,\"\"\n"
            "\"a \"\"quoted\"\", name\",1,,,,1,\"canonical\",\"\",,,\"\"\n");
}

TEST(Plots, TheAxisNamesFramesByTheirIds) {
  const TemporaryFolder folder;
  Inspection inspection = *smallInspection(folder.path());
  EXPECT_EQ(errorPlot(inspection).x.title, "frame");
  EXPECT_TRUE(errorPlot(inspection).x.names.empty()) << "a count needs no names";
  auto scene = std::make_shared<Scene>(*inspection.scene);
  scene->frames[1].id = "0002";  // every second frame of a sequence
  inspection.scene = scene;
  const PlotAxis axis = errorPlot(inspection).x;
  EXPECT_EQ(axis.title, "frame");
  ASSERT_EQ(axis.names.size(), inspection.evidence.size());
  EXPECT_EQ(axis.names[1], std::pair(1.0, std::string("0002")));
}

TEST(Plots, ErrorsOfEveryFrame) {
  const TemporaryFolder folder;
  const auto inspection = smallInspection(folder.path());
  const PlotData plot = errorPlot(*inspection);
  ASSERT_EQ(plot.series.size(), 1u) << "dual refused every frame";
  EXPECT_EQ(plot.series[0].name, "canonical");
  EXPECT_EQ(plot.series[0].colour, modelColour("canonical"));
  ASSERT_EQ(plot.series[0].points.size(), 6u);
  for (int i = 0; i < 6; ++i) {
    EXPECT_NEAR(plot.series[0].points[std::size_t(i)].y, 100 / (2 * kRadiusPx), 1e-12);
    EXPECT_EQ(plot.series[0].points[std::size_t(i)].target.frame, i);
  }
  EXPECT_FALSE(plot.y.log);
  ASSERT_EQ(plot.shades.size(), 1u);  // frames 0 to 3 train
  EXPECT_EQ(plot.shades[0].from, -0.5);
  EXPECT_EQ(plot.shades[0].to, 3.5);
  inspection->models["canonical"].frames[2].rows[0].metrics->contourErrorPct = 1000;
  EXPECT_TRUE(errorPlot(*inspection).y.log);
  EXPECT_FALSE(errorPlot(Inspection{}).empty.empty());
}

TEST(Plots, DialOfAPredictionThatIsOnePixelTooLarge) {
  const TemporaryFolder folder;
  const PlotData plot = residualDial(*smallInspection(folder.path()), 2, -1);
  ASSERT_EQ(plot.series.size(), 1u);
  EXPECT_TRUE(plot.dial);
  // Not the mean contour distance of the error table, which is another number of the same prediction: said so in both places.
  EXPECT_THAT(plot.title, HasSubstr("Signed distance, px"));
  EXPECT_THAT(plot.y.title, HasSubstr("signed distance, observed to predicted contour (px)"));
  EXPECT_THAT(plot.series[0].name, HasSubstr("mean |d| 1 px"));
  for (const PlotPoint& p : plot.series[0].points) {
    EXPECT_NEAR(p.y, 1, 0.05);  // polygons instead of circles
    EXPECT_EQ(*p.target.direction, p.x);
    EXPECT_EQ(p.target.highlight, 0);
  }
  EXPECT_FALSE(residualDial(*smallInspection(folder.path()), 2, 5).empty.empty());
}

TEST(Plots, ADialHasANumberWhateverItsRange) {
  for (double largest = 1e-3; largest < 1e4; largest *= 1.01) {
    const auto ticks = dialTicks({}, largest);
    ASSERT_FALSE(ticks.empty()) << largest;
    ASSERT_LE(ticks.size(), 4u) << largest;
    for (const auto& [value, label] : ticks) EXPECT_TRUE(value > 0 && value <= largest) << largest;
  }
}

TEST(Plots, TheDialShowsOneHighlightForAllModels) {
  const TemporaryFolder folder;
  const auto inspection = smallInspection(folder.path());
  Highlight second = inspection->evidence[1].highlights[0];
  for (Pixel& p : second.contour.points) p.x() += 40;
  inspection->evidence[1].highlights.push_back(second);
  FrameComparison& missed = inspection->models["dual"].frames[1];  // dual meets the second highlight only
  missed.prediction = inspection->models["canonical"].frames[1].prediction;
  missed.rows = {{0, -1, {}, Failure{Reason::NotReached, ""}, {}}, {1, 0, ContourMetrics{}, {}, {}}};
  EXPECT_EQ(residualDial(*inspection, 1, -1).series.size(), 1u);
  ASSERT_EQ(residualDial(*inspection, 1, 1).series.size(), 1u);
  EXPECT_THAT(residualDial(*inspection, 1, 1).series[0].name, HasSubstr("dual"));
}

TEST(Plots, SemiAxesWithTheirModels) {
  const TemporaryFolder folder;
  const PlotData plot = semiAxesPlot(*smallInspection(folder.path()));
  ASSERT_EQ(plot.series.size(), 1u) << "a hyperboloid has no semi-axes";
  const std::vector<PlotPoint>& p = plot.series[0].points;
  ASSERT_EQ(p.size(), 3u);
  EXPECT_NEAR(p[0].y, 0.25, 1e-12);
  EXPECT_NEAR(p[1].y, 0.2, 1e-12);
  EXPECT_NEAR(p[2].y, 0.12, 1e-12);
  EXPECT_EQ(p[0].target.model, "canonical");
}

TEST(Plots, LobeAndItsFit) {
  FrameSamples samples;
  samples.frame = 3;
  samples.model = "reflectance";
  FrameSamples::Lobe lobe;
  lobe.observed = 0;
  lobe.level = 0.5;
  lobe.roughness = 0.1;
  LobeSamples s;
  s.fit = LobeFit{std::log(7.0), 0.1, 0.01, 2};
  s.samples = {{{10, 20}, 0, std::log(7.0), 0.3, true}, {{12, 20}, 0.1, std::log(7.0) - 1, -0.3, false}};
  lobe.samples = s;
  samples.lobes = {lobe};
  const PlotData plot = lobePlot(samples, -1);
  ASSERT_EQ(plot.series.size(), 5u);  // faint, fitted, the lobe, the model's lobe, the level
  EXPECT_NEAR(plot.series[1].points[0].y, 0, 1e-12);
  EXPECT_NEAR(plot.series[0].points[0].y, -1, 1e-12);
  EXPECT_NEAR(plot.series[0].points[0].x, 0.1 * 180 / std::numbers::pi, 1e-12);
  EXPECT_EQ(*plot.series[0].points[0].target.direction, -0.3);
  EXPECT_NEAR(plot.series[2].points.back().y, -1, 1e-12);  // (alpha / m)^2 = 1 at the widest sample
  EXPECT_NEAR(plot.series[4].points[0].y, std::log(0.5), 1e-12);
  EXPECT_FALSE(lobePlot(samples, 4).empty.empty());
  samples.failure = "No surface.";
  EXPECT_EQ(lobePlot(samples, -1).empty, "No surface.");
}

TEST(Plots, EveryLobeOverTheMeasuredProfile) {
  FrameSamples samples;
  samples.frame = 3;
  samples.frameId = "0003";
  FrameSamples::Lobe lobe;
  lobe.observed = 0;
  lobe.level = 0.5;
  LobeComparison c;
  c.measured = {{0, 1, 0.01, 5}, {0.1, 0.4, 0.02, 9}};
  c.matches.resize(4);
  const Lobe order[] = {Lobe::Phong, Lobe::BlinnPhong, Lobe::TorranceSparrow, Lobe::Ggx};
  for (std::size_t k = 0; k < 4; ++k) {
    c.matches[k].lobe = order[k];
    c.matches[k].m = 0.1;
    c.matches[k].rmsPct = 4 - double(k);
    c.matches[k].profile = {1, 0.37};
  }
  c.matches[0].failure = Failure{Reason::NotConverged, "the pixels do not tell the lobe's width"};
  c.matches[0].profile.clear();
  c.matches[2].asGood = c.matches[3].asGood = true;
  c.best = 3;
  c.pixels = 14;
  c.clipped = 17;
  lobe.comparison = c;
  samples.lobes = {lobe};
  const PlotData plot = lobesPlot(samples, -1);
  ASSERT_EQ(plot.series.size(), 6u);  // four lobes, the pixels, the level
  EXPECT_NE(plot.title.find("17 clipped pixels left out"), std::string::npos);
  EXPECT_NE(plot.title.find("0003"), std::string::npos);
  EXPECT_NE(plot.series[1].name.find("do not tell"), std::string::npos);
  EXPECT_EQ(plot.series[2].name.find("as good"), std::string::npos);
  EXPECT_NE(plot.series[2].name.find("rms 3 %"), std::string::npos);
  EXPECT_NE(plot.series[3].name.find("as good"), std::string::npos);
  EXPECT_NE(plot.series[4].name.find("best"), std::string::npos);
  EXPECT_NEAR(plot.series[4].points[1].x, 0.1 * 180 / std::numbers::pi, 1e-12);
  EXPECT_NEAR(plot.series[4].points[1].y, 0.37, 1e-12);
  const PlotPoint& measured = plot.series[0].points[1];
  EXPECT_NEAR(measured.y, 0.4, 1e-12);
  EXPECT_NEAR(measured.band->first, 0.38, 1e-12);
  EXPECT_NEAR(measured.band->second, 0.42, 1e-12);
  EXPECT_NEAR(plot.series[5].points[0].y, 0.5, 1e-12);
  std::set<std::pair<Colour, Dash>> styles;
  for (int k = 0; k < 4; ++k) styles.insert({plot.series[std::size_t(k + 1)].colour, plot.series[std::size_t(k + 1)].dash});
  EXPECT_EQ(styles.size(), 4u);
  EXPECT_FALSE(lobesPlot(samples, 4).empty.empty());
  samples.lobes[0].comparison.reset();
  samples.lobes[0].comparisonFailure = Failure{Reason::TooFewPoints, "20 pixels"};
  EXPECT_NE(lobesPlot(samples, -1).empty.find("20 pixels"), std::string::npos);
}

TEST(Plots, SamplesOfAFrameOnTheSphere) {
  const TemporaryFolder folder;
  const FrameSamples samples = frameSamples(*smallInspection(folder.path()), 5, "canonical");
  EXPECT_EQ(samples.failure, "");
  ASSERT_EQ(samples.angles.size(), 1u);
  const PlotData plot = limitAnglePlot(samples, -1);
  ASSERT_EQ(plot.series.size(), 2u);
  for (std::size_t i = 0; i < plot.series[0].points.size(); ++i)
    EXPECT_GT(plot.series[1].points[i].y, plot.series[0].points[i].y) << "a larger contour reaches larger angles";
  ASSERT_EQ(samples.lobes.size(), 1u);
  EXPECT_NE(samples.lobes[0].samples.has_value(), samples.lobes[0].failure.has_value());
  EXPECT_FALSE(frameSamples(*smallInspection(folder.path()), 77, "canonical").failure.empty());
}

/// As contours in photographs, lines of the timeline and ellipsoids: what a poor fit says is pale, named so, and dashed where it
/// is a line.
TEST(Plots, WhatIsPoorIsPaleDashedAndNamedSo) {
  const TemporaryFolder folder;
  const auto inspection = smallInspection(folder.path());
  ModelResult& result = inspection->models["canonical"];
  const auto samples = [&] { return frameSamples(*inspection, 5, "canonical"); };
  const auto conditioning = [&] {  // its views are made up: no linear system follows from them
    const std::vector<Conditioning> all = conditioningOf(*inspection);
    Conditioning c = *std::find_if(all.begin(), all.end(), [](const Conditioning& of) { return of.model == "canonical"; });
    c.singularValues = {3, 2, 1};
    return c;
  };
  const auto lobe = [&] {  // the model's own, as if it had one
    FrameSamples of = samples();
    of.lobes.at(0).samples = LobeSamples{};
    of.lobes.at(0).samples->samples = {{{10, 20}, 0.1, 0, 0, true}};
    of.lobes.at(0).roughness = 0.1;
    return lobePlot(of, -1).series.at(2);
  };
  const auto chip = [&] {  // beside its numbers
    for (const OverlayCaption& c : frameOverlay(*inspection, 5, {}).captions)
      if (c.text.find("canonical") != std::string::npos) return c.colour;
    return Colour{};
  };
  const auto series = [&]() -> std::map<std::string, PlotSeries> {
    Tradeoff tradeoff;
    tradeoff.points.resize(1);
    tradeoff.points[0].model = "canonical";
    tradeoff.points[0].rankedErrorPct = tradeoff.points[0].predictUs = 1;
    tradeoff.points[0].poor = result.fits.front().fit->poor;
    return {{"error", errorPlot(*inspection).series.at(0)},
            {"mean", errorPlot(*inspection, {{}, true}).series.at(0)},
            {"dial", residualDial(*inspection, 5, -1).series.at(0)},
            {"axes", semiAxesPlot(*inspection).series.at(0)},
            {"scatter", scatterPlot(*inspection, highlightRows(*inspection), {}).plot.series.at(0)},
            {"tradeoff", tradeoffPlot(tradeoff).series.back()},
            {"limit-angle", limitAnglePlot(samples(), -1).series.at(1)},
            {"singular", singularValuePlot({conditioning()}).series.at(0)}};
  };
  for (const auto& [plot, s] : series()) {
    EXPECT_EQ(s.colour, modelColour("canonical")) << plot;
    EXPECT_EQ(s.dash, Dash::Solid) << plot;
    EXPECT_EQ(s.name.find("poor"), std::string::npos) << plot;
  }
  EXPECT_EQ(lobe().colour, modelColour("canonical"));
  EXPECT_EQ(lobe().name.rfind("canonical, m = ", 0), 0u) << lobe().name;
  EXPECT_EQ(chip(), modelColour("canonical"));
  for (ModelResult::Fit& fit : result.fits) fit.fit->poor = "a fifth of the radius remains";
  for (const auto& [plot, s] : series()) {
    EXPECT_EQ(s.colour, pale(modelColour("canonical"))) << plot;
    if (s.shape != PlotShape::Points) EXPECT_EQ(s.dash, Dash::Dashed) << plot;
    EXPECT_EQ(s.name.rfind(plot == "limit-angle" ? "predicted contour, poor" : "canonical, poor", 0), 0u)
        << plot << ": " << s.name;
  }
  EXPECT_EQ(lobe().colour, pale(modelColour("canonical")));
  EXPECT_EQ(lobe().dash, Dash::Dashed);
  EXPECT_EQ(lobe().name.rfind("canonical, poor, m = ", 0), 0u) << lobe().name;
  EXPECT_EQ(chip(), pale(modelColour("canonical")));
}

TEST(Plots, EveryKindHasAName) {
  EXPECT_EQ(plotKinds().size(), 10u);
  for (const PlotKind& k : plotKinds()) EXPECT_GT(std::string(k.help).size(), 20u) << k.id;
}

class PlotDrawing : public testing::Test {
 protected:
  Image draw() {
    Canvas canvas(width_, height_, kDarkBackground);
    view_.paint(canvas, width_, height_);
    return canvas.image();
  }
  int width_ = 600, height_ = 400;
  PlotView view_;
};

bool isColour(const Image& image, const Eigen::Vector2d& at, const Colour& colour) {
  const int x = int(at.x()), y = int(at.y());
  for (int c = 0; c < 3; ++c)
    if (std::abs(image.at(x, y, c) - colour[std::size_t(c)]) > 0.04) return false;
  return true;
}

int countOf(const Image& image, const Colour& colour) {
  int n = 0;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) n += isColour(image, Eigen::Vector2d(x, y), colour);
  return n;
}

TEST_F(PlotDrawing, SamplesAreDrawnWhereTheyArePicked) {
  view_.show(line({{0, 1}, {1, 8}, {2, 3}, {3, 5}}));
  const Image image = draw();
  double before = -1;
  for (int i = 0; i < 4; ++i) {
    const auto at = view_.positionOf({0, i});
    ASSERT_TRUE(at) << i;
    EXPECT_TRUE(isColour(image, *at, modelColour("canonical"))) << i << " at " << at->transpose();
    EXPECT_GT(at->x(), before);
    before = at->x();
    const auto picked = view_.at(*at + Eigen::Vector2d(3, -2), 8);
    ASSERT_TRUE(picked);
    EXPECT_EQ(picked->point, i);
  }
  EXPECT_LT(view_.positionOf({0, 1})->y(), view_.positionOf({0, 0})->y()) << "larger values are higher up";
  EXPECT_FALSE(view_.at({3, 3}, 8));
  EXPECT_FALSE(view_.positionOf({0, 9}));
}

TEST_F(PlotDrawing, TheSelectionIsMarked) {
  view_.show(line({{0, 1}, {1, 8}, {2, 3}}));
  const Image without = draw();
  Selection s;
  s.frame = 1;
  view_.setSelection(s);
  const Image with = draw();
  const Eigen::Vector2d at = *view_.positionOf({0, 1}) + Eigen::Vector2d(6, 0);  // on the ring
  EXPECT_TRUE(isColour(with, at, {1, 1, 1}) || isColour(with, at + Eigen::Vector2d(1, 0), {1, 1, 1}) ||
              isColour(with, at - Eigen::Vector2d(1, 0), {1, 1, 1}));
  EXPECT_FALSE(isColour(without, at, {1, 1, 1}) || isColour(without, at + Eigen::Vector2d(1, 0), {1, 1, 1}) ||
               isColour(without, at - Eigen::Vector2d(1, 0), {1, 1, 1}));
}

TEST_F(PlotDrawing, TheLegendGivesWayInALowPicture) {
  PlotData plot = line({{0, 1}, {1, 8}});
  for (int i = 0; i < 6; ++i) {
    plot.series.push_back(plot.series.front());
    plot.series.back().name = "a long name in the legend " + std::to_string(i);
  }
  plot.y.title = "a title that is longer than the axis is high (%)";
  width_ = 260, height_ = 150;
  view_.show(plot);
  draw();
  const auto low = view_.positionOf({0, 0}), high = view_.positionOf({0, 1});
  ASSERT_TRUE(low && high);
  EXPECT_GT(low->y() - high->y(), 35);
}

TEST_F(PlotDrawing, ZoomKeepsTheValueUnderTheMouse) {
  view_.show(line({{0, 1}, {1, 8}, {2, 3}, {3, 5}}));
  draw();
  const Eigen::Vector2d at = *view_.positionOf({0, 1}), next = *view_.positionOf({0, 2});
  view_.zoom(2, at, false);
  draw();
  EXPECT_NEAR((*view_.positionOf({0, 1}) - at).norm(), 0, 1);
  EXPECT_NEAR(view_.positionOf({0, 2})->x() - at.x(), 2 * (next.x() - at.x()), 2);
  EXPECT_TRUE(view_.zoomed());
  view_.pan({-1e6, 0});  // no further than the data
  draw();
  EXPECT_TRUE(view_.positionOf({0, 3}));
  view_.showAll();
  draw();
  EXPECT_NEAR((*view_.positionOf({0, 2}) - next).norm(), 0, 1);
}

/// Two models with the same errors: a click there leaves the selected one selected, whichever is drawn on top.
TEST_F(PlotDrawing, TheSelectedModelStaysWherePointsCoincide) {
  PlotData plot = line({{0, 1}, {1, 8}, {2, 3}});
  PlotSeries second = plot.series[0];
  second.name = "dual";
  for (PlotPoint& p : second.points) p.target.model = "dual";
  second.points[2].y = 4;
  plot.series.push_back(second);
  view_.show(plot);
  draw();
  const Eigen::Vector2d both = *view_.positionOf({0, 1}) + Eigen::Vector2d(2, 1);
  for (const int selected : {0, 1}) {
    view_.setSelection({0, plot.series[std::size_t(selected)].name, -1, "", {}});
    ASSERT_TRUE(view_.at(both, 10));
    EXPECT_EQ(view_.at(both, 10)->series, selected);
    EXPECT_EQ(view_.at(both, 10)->point, 1);
    EXPECT_EQ(view_.at(*view_.positionOf({0, 2}), 10)->series, 0) << "where they differ the click says which";
    EXPECT_EQ(view_.at(*view_.positionOf({1, 2}), 10)->series, 1);
  }
}

TEST_F(PlotDrawing, BarsArePickedByTheirColumn) {
  PlotData plot = line({{0, 4}, {1, -2}, {2, 0}});
  plot.series[0].shape = PlotShape::Bars;
  view_.show(plot);
  const Image image = draw();
  const Eigen::Vector2d top = *view_.positionOf({0, 0});
  EXPECT_TRUE(isColour(image, top + Eigen::Vector2d(20, 8), modelColour("canonical"))) << "below its upper end";
  EXPECT_EQ(view_.at(top + Eigen::Vector2d(0, 120), 1)->point, 0);
  EXPECT_EQ(view_.at({view_.positionOf({0, 2})->x(), top.y() + 5}, 1)->point, 2) << "also where the bar is empty";
}

TEST_F(PlotDrawing, DialTurnsAsThePhotograph) {
  // One short arc per quarter: where it is drawn, and where it is picked, is its direction in the photograph.
  const struct {
    double direction;
    Eigen::Vector2d side;  // window px, y down
  } quarters[] = {{0, {1, 0}}, {std::numbers::pi / 2, {0, 1}}, {std::numbers::pi, {-1, 0}}, {-std::numbers::pi / 2, {0, -1}}};
  for (const auto& quarter : quarters) {
    SCOPED_TRACE(quarter.direction);
    PlotData plot = line({{quarter.direction - 0.1, 0.5}, {quarter.direction, 0.5}, {quarter.direction + 0.1, 0.5}});
    plot.dial = true;
    plot.series[0].inLegend = false;  // the only thing of its colour is the arc
    plot.y.to = 1;
    plot.y.from = -1;
    view_.show(plot);
    const Image image = draw();
    Eigen::Vector2d sum(0, 0);
    int n = 0;
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x)
        if (isColour(image, Eigen::Vector2d(x, y), modelColour("canonical"))) sum += Eigen::Vector2d(x, y), ++n;
    ASSERT_GT(n, 5);
    const Eigen::Vector2d drawn = sum / n, picked = *view_.positionOf({0, 1});
    EXPECT_LT((drawn - picked).norm(), 4) << "picked where it is drawn";
    // The circle's middle is not the window's: the title is above it. Everything else is half as far off at most.
    const Eigen::Vector2d out = drawn - Eigen::Vector2d(image.width / 2.0, image.height / 2.0);
    EXPECT_GT(out.normalized().dot(quarter.side), 0.97);
    const auto at = view_.at(picked, 3);
    ASSERT_TRUE(at);
    EXPECT_EQ(at->point, 1);
  }
}

TEST_F(PlotDrawing, AnEmptyPlotSaysWhyAndPicksNothing) {
  PlotData plot;
  plot.id = "error";
  plot.title = "Error";
  plot.empty = "No results yet";
  view_.show(plot);
  const Image image = draw();
  EXPECT_GT(countOf(image, {0.64, 0.66, 0.68}), 20) << "the sentence";
  EXPECT_FALSE(view_.at({300, 200}, 1000));
}

TEST_F(PlotDrawing, ExportsAreWholeFiles) {
  const TemporaryFolder folder;
  const auto inspection = smallInspection(folder.path());
  for (const PlotData& plot : {errorPlot(*inspection), residualDial(*inspection, 1, -1), semiAxesPlot(*inspection)}) {
    const std::string svg = (folder.path() / "plot.svg").string();
    writePlotSvg(plot, {false, 1}, {}, 640, 400, svg);
    const std::string text = readFile(svg);
    EXPECT_THAT(text, HasSubstr("<svg"));
    EXPECT_THAT(text, HasSubstr("</svg>"));
    EXPECT_THAT(text, HasSubstr("#009e73")) << plot.id << ": the model's colour";  // Okabe-Ito bluish green
    for (const bool dark : {true, false}) {
      const Image image = plotImage(plot, {dark, 2}, {}, 1280, 800);
      ASSERT_EQ(image.width, 1280);
      EXPECT_GT(countOf(image, modelColour("canonical")), 200) << plot.id;
      EXPECT_GT(countOf(image, dark ? kDarkBackground : kLightBackground), 1280 * 300) << plot.id;
    }
    PlotData without = plot;
    without.series.clear();
    EXPECT_EQ(countOf(plotImage(without, {true, 1}, {}, 640, 400), modelColour("canonical")), 0);
    const std::string csv = (folder.path() / "plot.csv").string();
    writePlotCsv(plot, csv);
    EXPECT_EQ(readFile(csv), plotCsv(plot));
  }
  // The caption takes its place from the plot, not from the page.
  const std::string svg = (folder.path() / "captioned.svg").string();
  const PlotCaption caption{"Errors < 1 %", 12};
  writePlotSvg(errorPlot(*inspection), {false, 1}, {}, 640, 400, svg, caption);
  EXPECT_THAT(readFile(svg), HasSubstr("<desc>Errors &lt; 1 %</desc>"));
  EXPECT_THAT(readFile(svg), HasSubstr(">Errors &lt; 1 %</text>"));
  EXPECT_THAT(readFile(svg), HasSubstr("viewBox=\"0 0 640 400\""));
  const Image with = plotImage(errorPlot(*inspection), {false, 1}, {}, 640, 400, caption);
  EXPECT_EQ(with.height, 400);
  EXPECT_NE(with.data, plotImage(errorPlot(*inspection), {false, 1}, {}, 640, 400).data);
  EXPECT_THROW(writePlotSvg(errorPlot(*inspection), {}, {}, 640, 400, (folder.path() / "no/such/folder.svg").string()),
               InputError);
  EXPECT_THROW(plotImage(errorPlot(*inspection), {}, {}, 10, 10), std::invalid_argument);
}

}  // namespace
}  // namespace glint::viz
