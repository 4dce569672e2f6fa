// SPDX-License-Identifier: BSD-3-Clause
// What a painter does whatever takes its strokes, and the strokes as SVG.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/base64.h"
#include "core/draw/overlay_painter.h"
#include "core/draw/plot_view.h"
#include "core/draw/svg_painter.h"

namespace glint::draw {
namespace {

using testing::HasSubstr;
using testing::Not;

int countOf(const std::string& text, const std::string& part) {
  int n = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
  return n;
}

/// RFC 4648, section 10.
TEST(Base64, AsTheStandardHasIt) {
  const auto of = [](const std::string& text) { return base64({text.begin(), text.end()}); };
  EXPECT_EQ(of(""), "");
  EXPECT_EQ(of("f"), "Zg==");
  EXPECT_EQ(of("fo"), "Zm8=");
  EXPECT_EQ(of("foo"), "Zm9v");
  EXPECT_EQ(of("foob"), "Zm9vYg==");
  EXPECT_EQ(of("fooba"), "Zm9vYmE=");
  EXPECT_EQ(of("foobar"), "Zm9vYmFy");
}

TEST(SvgPainter, TextIsEscapedAndHasItsWidth) {
  SvgPainter painter(100, 50);
  painter.text({10, 20}, "a<b> & \"c\"\x1b", 10, {1, 0, 0}, Align::Right, false, true);
  const std::string svg = painter.document("<title> & more");
  EXPECT_THAT(svg, HasSubstr("a&lt;b&gt; &amp; &quot;c&quot;"));
  EXPECT_THAT(svg, HasSubstr("<title>&lt;title&gt; &amp; more</title>"));
  EXPECT_THAT(svg, HasSubstr("text-anchor=\"end\" font-weight=\"bold\" x=\"10\" y=\"20\""));
  EXPECT_THAT(svg, HasSubstr("fill=\"#ff0000\""));
  EXPECT_THAT(svg, Not(HasSubstr("\x1b")));
  EXPECT_THAT(svg, HasSubstr("viewBox=\"0 0 100 50\""));
}

/// DejaVu Sans 2.37: A has 684, i 278 and the digits 636 thousandths; bold A 774.
TEST(SvgPainter, WidthsAreThoseOfTheFont) {
  const SvgPainter painter(100, 50);
  EXPECT_NEAR(painter.textWidth("A", 1000), 684, 1e-9);
  EXPECT_NEAR(painter.textWidth("Ai0", 10), 15.98, 1e-9);
  EXPECT_NEAR(painter.textWidth("A", 1000, true), 774, 1e-9);
  EXPECT_GT(painter.textWidth("\u03b1", 10), 5) << "other letters have a usual width";
  EXPECT_EQ(painter.textWidth("", 10), 0);
}

TEST(SvgPainter, LinesAreCutWithoutClipPaths) {
  SvgPainter painter(100, 50);
  painter.stroke({{-10, 20}, {200, 20}}, false, {0, 0, 0}, 2, Dash::Dashed, {10, 10, 50, 30});
  const std::string svg = painter.element("line");
  EXPECT_THAT(svg, HasSubstr("d=\"M10,20 L60,20\""));
  EXPECT_THAT(svg, HasSubstr("stroke-dasharray"));
  EXPECT_THAT(svg, Not(HasSubstr("clip")));
  EXPECT_THAT(svg, Not(HasSubstr("xmlns"))) << "in a page it needs none";
}

TEST(Painter, TextsAreShortenedAndBrokenByTheirWidth) {
  const SvgPainter painter(100, 50);
  EXPECT_EQ(painter.fitted("abc", 10, 100), "abc");
  EXPECT_EQ(painter.fitted("0000000000", 10, 6.36 * 4), "000\u2026");  // dots have 650 thousandths
  EXPECT_EQ(painter.fitted("\u03b1\u03b1\u03b1\u03b1", 10, 6.5 * 2 + 0.1), "\u03b1\u2026") << "whole letters";
  EXPECT_EQ(painter.fitted("abc", 10, 1), "");
  EXPECT_EQ(painter.wrapped("one two  three", 10, painter.textWidth("one two", 10) + 0.1), (std::vector<std::string>{"one two", "three"}));
}

TEST(PlotPainter, EverySampleSaysItsValueUnderTheMouse) {
  PlotData plot;
  plot.id = "error";
  PlotSeries series;
  series.name = "one";
  for (int i = 0; i < 3; ++i) {
    PlotPoint p;
    p.x = i;
    p.y = i == 1 ? std::nan("") : 2 + i;
    p.noValue = i == 1;
    p.label = "sample " + std::to_string(i) + "\nof <three>";
    series.points.push_back(p);
  }
  plot.series = {series};
  plot.noValue = "missed";
  SvgPainter painter(400, 300);
  PlotView view;
  view.show(plot);
  view.paint(painter, 400, 300);
  const std::string svg = painter.element("plot");
  for (int i = 0; i < 3; ++i) EXPECT_THAT(svg, HasSubstr("<title>sample " + std::to_string(i) + "\nof &lt;three&gt;</title>"));
  EXPECT_THAT(svg, HasSubstr(">missed</text>"));
  EXPECT_LT(view.positionOf({0, 1})->y(), view.positionOf({0, 2})->y()) << "the cross stands above the values";
}

TEST(PlotPainter, ANotedSampleIsNamedInsideThePicture) {
  PlotData plot;
  PlotSeries series;
  series.shape = PlotShape::Points;
  for (const double x : {0.0, 1.0}) {
    PlotPoint p;
    p.x = x;
    p.note = "balanced, exact";
    series.points.push_back(p);
  }
  plot.series = {series};
  SvgPainter painter(400, 300);
  paintPlot(painter, plot, {false, 1}, rangeOf(plot), {}, 400, 300);
  const std::string svg = painter.element("plot");
  EXPECT_EQ(countOf(svg, ">balanced, exact</text>"), 2);
  EXPECT_EQ(countOf(svg, "text-anchor=\"end\" font-weight=\"bold\""), 1) << "that at the right border stands at its left";
}

TEST(OverlayPainter, MarksOutsideTheirBoxAreNotPainted) {
  FrameOverlay overlay;
  OverlayMark mark;
  mark.halo = false;
  mark.shape = MarkShape::Circle;
  mark.at = {5, 5};
  mark.label = "inside";
  overlay.marks.push_back(mark);
  mark.at = {5, 11};
  mark.label = "outside";
  overlay.marks.push_back(mark);
  SvgPainter painter(100, 100);
  paintOverlay(painter, overlay, {-0.5, -0.5, 10, 10}, {0, 0, 100, 100}, 1, true);
  const std::string svg = painter.element("overlay");
  EXPECT_EQ(countOf(svg, "<path"), 1);
  EXPECT_THAT(svg, HasSubstr("<circle cx=\"55\" cy=\"55\"")) << "(0, 0) is the middle of the first pixel";
  EXPECT_THAT(svg, Not(HasSubstr("outside")));
}

}  // namespace
}  // namespace glint::draw
