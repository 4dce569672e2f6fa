// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/base/image.h"

namespace glint::viz {

/// What the numbers of an image are.
enum class Values {
  Srgb,
  Linear,
  Linearised
};  ///< codes 0..1 of the sRGB curve (a photograph); radiance; a photograph made linear

/// How an image is turned into a picture. Changes no result.
struct Development {
  double stops = 0;          ///< linear light is multiplied by 2^stops; at 0 radiance 1 is white
  double gamma = 1;          ///< > 1 brightens the dark parts: shown = (usual curve)^(1/gamma)
  bool falseColour = false;  ///< mean of the channels, linear, on a perceptually uniform map
  bool markClipped = false;  ///< paint what is at or above white (photograph: at its largest code) and what is no number

  friend bool operator==(const Development&, const Development&) = default;
};

/// 8-bit sRGB, row-major, 3 bytes a pixel.
struct Picture8 {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;
};

inline constexpr std::array<std::uint8_t, 3> kClippedRgb{255, 0, 170}, kBadRgb{230, 30, 30};

/// @param image  1 or 3 channels.
Picture8 develop(const Image& image, Values values, const Development& how);

/// Perceptually uniform map (viridis), 256 colours from low to high.
const std::array<std::array<std::uint8_t, 3>, 256>& uniformColours();

/// Scale of a false-colour picture: radiance at places 0..1 along the map.
struct ScaleTick {
  double place;
  std::string text;
};
std::vector<ScaleTick> falseColourTicks(const Development& how);

/// The value of a pixel as short lines, for writing it into the pixel: codes 0..255 of a photograph, three digits of radiance.
struct PixelText {
  int x = 0, y = 0;
  std::vector<std::string> lines;
  bool dark = false;  ///< the pixel is bright on screen, so the text is dark
};
/// Texts of the pixels in [x0, x1] x [y0, y1], cut to the image. @param shown  what is on screen, for the contrast.
std::vector<PixelText> pixelTexts(const Image& image, Values values, const Picture8& shown, int x0, int y0, int x1, int y1);
/// One pixel's value as a line of text: "sRGB 64 64 64", "radiance 0.12 0.11 0.1", "linear 0.05 0.05 0.05".
std::string valueText(const Image& image, Values values, int x, int y);

}  // namespace glint::viz
