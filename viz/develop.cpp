// SPDX-License-Identifier: BSD-3-Clause
#include "viz/develop.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "core/base/image.h"
#include "core/base/number_text.h"
#include "core/base/outcome.h"

namespace glint::viz {
namespace {

constexpr int kTable = 1 << 16;  // every code of a 16-bit photograph has its own entry
constexpr float kLargestCode = 1.0f - 0.5f / 65535;

std::uint8_t byteOf(double v) { return static_cast<std::uint8_t>(std::lround(255 * std::clamp(v, 0.0, 1.0))); }

/// Screen byte (or place on the colour map) of linear light where 1 is white.
double shown(double linear, const Development& how) {
  const double light = std::clamp(linear, 0.0, 1.0);
  return how.falseColour ? std::pow(light, 1 / how.gamma) : std::pow(srgbFromLinear(light), 1 / how.gamma);
}

}  // namespace

const std::array<std::array<std::uint8_t, 3>, 256>& uniformColours() {
  static const std::array<std::array<std::uint8_t, 3>, 256> colours = [] {
    cv::Mat ramp(1, 256, CV_8U), map;
    for (int i = 0; i < 256; ++i) ramp.at<std::uint8_t>(0, i) = static_cast<std::uint8_t>(i);
    cv::applyColorMap(ramp, map, cv::COLORMAP_VIRIDIS);
    std::array<std::array<std::uint8_t, 3>, 256> table{};
    for (int i = 0; i < 256; ++i) {
      const cv::Vec3b bgr = map.at<cv::Vec3b>(0, i);
      table[static_cast<std::size_t>(i)] = {bgr[2], bgr[1], bgr[0]};
    }
    return table;
  }();
  return colours;
}

Picture8 develop(const Image& image, Values values, const Development& how) {
  require(image.channels == 1 || image.channels == 3, "develop: 1 or 3 channels");
  require(how.gamma > 0, "develop: gamma > 0");
  Picture8 picture{image.width, image.height, {}};
  picture.rgb.resize(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height) * 3);
  const double gain = std::exp2(how.stops);
  const bool asIs = values == Values::Srgb && how.stops == 0 && how.gamma == 1 && !how.falseColour;
  // Input of the table: the photograph's code, or linear light after the gain; both 0..1.
  std::vector<std::uint8_t> table(kTable);
  if (!how.falseColour) {
    for (int i = 0; i < kTable; ++i) {
      const double v = static_cast<double>(i) / (kTable - 1);
      table[static_cast<std::size_t>(i)] = byteOf(asIs ? v : shown(values == Values::Srgb ? gain * linearFromSrgb(v) : v, how));
    }
  } else {
    for (int i = 0; i < kTable; ++i)
      table[static_cast<std::size_t>(i)] = byteOf(shown(static_cast<double>(i) / (kTable - 1), how));
  }
  const auto look = [&](double v) { return table[static_cast<std::size_t>(std::clamp(v, 0.0, 1.0) * (kTable - 1) + 0.5)]; };
  const auto& colours = uniformColours();
  const auto channels = static_cast<std::size_t>(image.channels);
  const std::size_t pixels = picture.rgb.size() / 3;
  const double inputGain = values == Values::Srgb ? 1 : gain;
  for (std::size_t i = 0; i < pixels; ++i) {
    const float* in = image.data.data() + i * channels;
    std::uint8_t* out = picture.rgb.data() + 3 * i;
    bool bad = false, clipped = false;
    for (std::size_t c = 0; c < channels; ++c) {
      bad = bad || !std::isfinite(in[c]);
      clipped = clipped || (values == Values::Srgb ? in[c] >= kLargestCode : in[c] * gain >= 1);
    }
    if (bad || (how.markClipped && clipped)) {
      const auto& mark = bad ? kBadRgb : kClippedRgb;
      std::copy(mark.begin(), mark.end(), out);
      continue;
    }
    if (how.falseColour) {
      double sum = 0;
      for (std::size_t c = 0; c < channels; ++c) sum += values == Values::Srgb ? linearFromSrgb(in[c]) : in[c];
      const auto& colour = colours[look(gain * sum / static_cast<double>(channels))];
      std::copy(colour.begin(), colour.end(), out);
      continue;
    }
    for (std::size_t c = 0; c < 3; ++c) out[c] = look(inputGain * in[std::min(c, channels - 1)]);
  }
  return picture;
}

std::vector<ScaleTick> falseColourTicks(const Development& how) {
  std::vector<ScaleTick> ticks;
  const double white = std::exp2(-how.stops);
  for (const double share : {0.0, 0.25, 0.5, 0.75, 1.0})
    ticks.push_back({std::pow(share, 1 / how.gamma), formatted("%.3g", share * white)});
  return ticks;
}

std::vector<PixelText> pixelTexts(const Image& image, Values values, const Picture8& shown, int x0, int y0, int x1, int y1) {
  require(shown.width == image.width && shown.height == image.height, "pixelTexts: sizes differ");
  std::vector<PixelText> texts;
  for (int y = std::max(0, y0); y <= std::min(y1, image.height - 1); ++y) {
    for (int x = std::max(0, x0); x <= std::min(x1, image.width - 1); ++x) {
      PixelText text;
      text.x = x;
      text.y = y;
      bool grey = true;
      for (int c = 1; c < image.channels; ++c) grey = grey && image.at(x, y, c) == image.at(x, y, 0);
      for (int c = 0; c < (grey ? 1 : image.channels); ++c) {
        const double v = image.at(x, y, c);
        text.lines.push_back(values == Values::Srgb ? formatted("%.0f", 255 * v) : formatted("%.3g", v));
      }
      const std::uint8_t* rgb = shown.rgb.data() + 3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
                                                        static_cast<std::size_t>(x));
      text.dark = 0.299 * rgb[0] + 0.587 * rgb[1] + 0.114 * rgb[2] > 140;
      texts.push_back(std::move(text));
    }
  }
  return texts;
}

std::string valueText(const Image& image, Values values, int x, int y) {
  if (x < 0 || y < 0 || x >= image.width || y >= image.height) return {};
  std::string text = values == Values::Srgb ? "sRGB" : values == Values::Linear ? "radiance" : "linear";
  for (int c = 0; c < image.channels; ++c) {
    const double v = image.at(x, y, c);
    text += " " + (values == Values::Srgb ? formatted("%.0f", 255 * v) : formatted("%.4g", v));
  }
  return text;
}

}  // namespace glint::viz
