// SPDX-License-Identifier: BSD-3-Clause
// What a painter does whatever takes its strokes, and the strokes as SVG.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "core/base/bytes.h"
#include "core/draw/contrast.h"
#include "core/draw/frame_overlay.h"
#include "core/draw/painter.h"
#include "core/draw/plot_header.h"
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

/// Digits of DejaVu Sans have 636 thousandths of the size, a blank 318, an ellipsis as usual 650.
TEST(Caption, IsBrokenByTheWidthOfThePage) {
  SvgPainter painter(200, 100);
  const double margins = 14, room = 6 * 6.36 + 3.18 + 0.1;  // two words of three digits
  const Caption two = captionOf(painter, "000 000  000", 10, room + margins, 100);
  EXPECT_EQ(two.lines, (std::vector<std::string>{"000 000", "000"}));
  EXPECT_NEAR(two.height, 2 * 13 + margins, 1e-9);
  EXPECT_EQ(captionOf(painter, "000 000 000", 10, room + margins, 30).lines, (std::vector<std::string>{"000 \u2026"}))
      << "there is room for one line";
  EXPECT_EQ(captionOf(painter, "0000000000", 10, 6.36 * 3 + 6.5 + 0.2 + margins, 100).lines,
            (std::vector<std::string>{"000\u2026"}));
  EXPECT_EQ(captionOf(painter, " ", 10, 200, 100).height, 0);
  EXPECT_EQ(captionOf(painter, "000", 10, 200, 10).height, 0) << "no room at all";
  paintCaption(painter, two, 60, {0, 0, 0});
  const std::string svg = painter.document("t", "a < b");
  EXPECT_THAT(svg, HasSubstr("x=\"7\" y=\"76.5\">000 000</text>"));
  EXPECT_THAT(svg, HasSubstr("x=\"7\" y=\"89.5\">000</text>"));
  EXPECT_THAT(svg, HasSubstr("<title>t</title>\n<desc>a &lt; b</desc>\n"));
  EXPECT_THAT(painter.document("t"), Not(HasSubstr("<desc>")));
}

TEST(Painter, TextsAreShortenedAndBrokenByTheirWidth) {
  const SvgPainter painter(100, 50);
  EXPECT_EQ(painter.fitted("abc", 10, 100), "abc");
  EXPECT_EQ(painter.fitted("0000000000", 10, 6.36 * 4 + 0.2), "000\u2026");  // dots have 650 thousandths
  EXPECT_EQ(painter.fitted("\u03b1\u03b1\u03b1\u03b1", 10, 6.5 * 2 + 0.1), "\u03b1\u2026") << "whole letters";
  EXPECT_EQ(painter.fitted("abc", 10, 1), "");
  EXPECT_EQ(painter.wrapped("one two  three", 10, painter.textWidth("one two", 10) + 0.1),
            (std::vector<std::string>{"one two", "three"}));
}

/// Counts how often it is asked for a width.
struct CountingPainter : SvgPainter {
  using SvgPainter::SvgPainter;
  double textWidth(const std::string& text, double sizePx, bool bold = false) const override {
    ++asked;
    return SvgPainter::textWidth(text, sizePx, bold);
  }
  mutable int asked = 0;
};

/// Names in files of others may be that long: letter by letter, a caption took a minute.
TEST(Painter, LongTextIsCutWithFewMeasurements) {
  const CountingPainter painter(100, 50);
  EXPECT_EQ(painter.fitted(std::string(100000, '0'), 10, 6.36 * 4 + 0.2), "000\u2026");
  EXPECT_LE(painter.asked, 20);  // bisection: 1 + log2(100000)
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

TEST(PlotPainter, ANotedSampleHasARingAndItsName) {
  PlotData plot;
  PlotSeries series;
  series.shape = PlotShape::Points;
  for (const double x : {0.0, 1.0}) {
    PlotPoint p;
    p.x = x;
    p.note = x > 0 ? "balanced, exact" : "";
    series.points.push_back(p);
  }
  plot.series = {series};
  SvgPainter painter(400, 300);
  const auto places = paintPlot(painter, plot, {false, 1}, rangeOf(plot), {}, 400, 300);
  ASSERT_TRUE(places);
  const std::string svg = painter.element("plot");
  const std::size_t at = svg.find(">balanced, exact</text>");
  ASSERT_NE(at, std::string::npos);
  const std::size_t x = svg.rfind(" x=\"", at);
  double left = 0;
  std::istringstream(svg.substr(x + 4)) >> left;  // whatever the locale
  EXPECT_LT(left, places->placeOf(plot, 0, plot.series[0].points[1]).x()) << "at the right border it stands at the left";
}

/// Points that are near to each other: their names stay apart, and beside their points.
TEST(NotePlaces, NamesNeverLieOverOneAnother) {
  const Box area{60, 10, 420, 190};
  for (const double apart : {0.0, 0.5, 4.0, 20.0, 60.0}) {
    SCOPED_TRACE(apart);
    const std::vector<Eigen::Vector2d> points{{100, 100}, {100 + apart, 100 - apart}, {470, 20}};
    const auto places = notePlaces(points, {40, 60, 50}, 15, area, 1);
    ASSERT_EQ(places.size(), 3u);
    for (std::size_t i = 0; i < 3; ++i) {
      ASSERT_TRUE(places[i]) << i;
      const Box& a = *places[i];
      EXPECT_GE(a.x, area.x);
      EXPECT_GE(a.y, area.y);
      EXPECT_LE(a.x + a.width, area.x + area.width);
      EXPECT_LE(a.y + a.height, area.y + area.height);
      EXPECT_LT(std::abs(a.y + 0.5 * a.height - points[i].y()), 70);
      for (std::size_t j = 0; j < 3; ++j) {
        const Box& b = *places[j];
        EXPECT_TRUE(i == j || a.x >= b.x + b.width || b.x >= a.x + a.width || a.y >= b.y + b.height || b.y >= a.y + a.height)
            << i << j;
        const Eigen::Vector2d& p = points[j];
        EXPECT_FALSE(p.x() > a.x && p.x() < a.x + a.width && p.y() > a.y && p.y() < a.y + a.height) << i << j;
      }
    }
  }
  EXPECT_FALSE(notePlaces({{50, 50}}, {400}, 15, {0, 0, 100, 100}, 1)[0]) << "without room it is left out";
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

/// Figures of the Web Content Accessibility Guidelines: 21 : 1 is the most there is, and #767676 the brightest grey that is text
/// on white.
TEST(Contrast, IsThatOfTheGuidelines) {
  EXPECT_NEAR(contrast({0, 0, 0}, {1, 1, 1}), 21, 1e-12);
  EXPECT_NEAR(contrast({1, 0, 0}, {1, 1, 1}), 3.998, 5e-4);
  const auto grey = [](int v) { return Colour{v / 255.0, v / 255.0, v / 255.0}; };
  EXPECT_GE(contrast(grey(0x76), {1, 1, 1}), 4.5);
  EXPECT_LT(contrast(grey(0x77), {1, 1, 1}), 4.5);
}

TEST(Contrast, EveryColourBecomesReadableAndWhatIsStays) {
  for (const Colour& ground : {kDarkBackground, kLightBackground, Colour{1, 1, 1}, Colour{0, 0, 0}})
    for (double r = 0; r <= 1; r += 0.25)
      for (double g = 0; g <= 1; g += 0.25)
        for (double b = 0; b <= 1; b += 0.25) {
          const Colour made = readableOn(ground, {r, g, b});
          EXPECT_GE(contrast(made, ground), 4.5) << r << " " << g << " " << b;
          if (contrast({r, g, b}, ground) >= 4.5) {
            EXPECT_EQ(made, (Colour{r, g, b}));
          }
        }
}

}  // namespace
}  // namespace glint::draw
