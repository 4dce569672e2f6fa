// SPDX-License-Identifier: BSD-3-Clause
#include "viz/develop.h"

#include <gtest/gtest.h>

#include <cmath>

namespace glint::viz {
namespace {

Image filled(int channels, float value) { return Image(2, 2, channels, value); }
int byteOf(const Image& image, Values values, const Development& how) { return develop(image, values, how).rgb[0]; }

TEST(Develop, APhotographIsShownCodeByCode) {
  for (int code = 0; code < 256; ++code) EXPECT_EQ(byteOf(filled(3, code / 255.f), Values::Srgb, {}), code);
}

/// IEC 61966-2-1: code 0.25 is linear 0.0509; two stops make 0.2035, code 0.489. Middle grey 0.18 is code 0.4614.
TEST(Develop, StopsAreFactorsOfTwoOfLinearLight) {
  Development how;
  how.stops = 2;
  EXPECT_NEAR(byteOf(filled(3, 0.25f), Values::Srgb, how), 0.489 * 255, 1);
  EXPECT_NEAR(byteOf(filled(1, 0.18f), Values::Linear, {}), 0.4614 * 255, 0.51);
  EXPECT_NEAR(byteOf(filled(1, 0.045f), Values::Linear, how), 0.4614 * 255, 0.51);
  how.stops = 0;
  how.gamma = 2;  // sqrt(0.4614) = 0.6793
  EXPECT_NEAR(byteOf(filled(1, 0.18f), Values::Linear, how), 0.6793 * 255, 0.6);
}

TEST(Develop, ClippedAndBadPixelsAreMarked) {
  Development how;
  how.stops = -3;
  how.markClipped = true;
  const auto marked = [&](const Image& image, Values values, const std::array<std::uint8_t, 3>& colour) {
    const Picture8 p = develop(image, values, how);
    return std::array<std::uint8_t, 3>{p.rgb[0], p.rgb[1], p.rgb[2]} == colour;
  };
  Image one = filled(3, 0.2f);
  one.at(0, 0, 1) = 1;  // a single channel at its largest code is lost, whatever the exposure
  EXPECT_TRUE(marked(one, Values::Srgb, kClippedRgb));
  EXPECT_FALSE(marked(filled(3, 254 / 255.f), Values::Srgb, kClippedRgb));
  EXPECT_FALSE(marked(filled(3, 7.9f), Values::Linear, kClippedRgb));  // radiance is lost on screen only, beyond 2^3
  EXPECT_TRUE(marked(filled(3, 8.1f), Values::Linear, kClippedRgb));
  how.markClipped = false;
  EXPECT_TRUE(marked(filled(1, std::nanf("")), Values::Linear, kBadRgb));
  EXPECT_FALSE(marked(one, Values::Srgb, kClippedRgb));
}

TEST(Develop, FalseColourIsAMonotoneMapOfLinearLight) {
  Development how;
  how.falseColour = true;
  how.stops = 1;
  const auto& colours = uniformColours();
  double before = -1;
  for (const auto& c : colours) {
    const double lightness = 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2];
    EXPECT_GT(lightness, before - 0.8);  // rounding of the table
    before = lightness;
  }
  const Picture8 p = develop(filled(3, 0.25f), Values::Linear, how);  // half of white, which is 0.5 at one stop
  const std::array<std::uint8_t, 3> shown{p.rgb[0], p.rgb[1], p.rgb[2]};
  EXPECT_TRUE(shown == colours[127] || shown == colours[128]);
  const std::vector<ScaleTick> ticks = falseColourTicks(how);
  EXPECT_EQ(ticks.back().text, "0.5");
  EXPECT_DOUBLE_EQ(ticks.back().place, 1);
}

TEST(Develop, ValuesAreWrittenAsTheyAre) {
  Image image(3, 2, 3);
  image.at(2, 1, 0) = 64 / 255.f;
  const Picture8 shown = develop(image, Values::Srgb, {});
  const std::vector<PixelText> texts = pixelTexts(image, Values::Srgb, shown, -5, -5, 99, 99);
  ASSERT_EQ(texts.size(), 6u);
  EXPECT_EQ(texts[0].lines, std::vector<std::string>{"0"});  // grey: one number
  EXPECT_EQ(texts[5].lines, (std::vector<std::string>{"64", "0", "0"}));
  EXPECT_EQ(texts[5].x, 2);
  EXPECT_EQ(valueText(image, Values::Srgb, 2, 1), "sRGB 64 0 0");
  EXPECT_EQ(valueText(image, Values::Srgb, 3, 1), "");
  image.at(2, 1, 0) = 0.25f;
  EXPECT_EQ(valueText(image, Values::Linear, 2, 1), "radiance 0.25 0 0");
  EXPECT_EQ(valueText(image, Values::Linearised, 2, 1), "linear 0.25 0 0");  // its scale is the camera's own
}

}  // namespace
}  // namespace glint::viz
