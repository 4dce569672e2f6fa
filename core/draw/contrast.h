// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>

#include "core/draw/colours.h"

namespace glint::draw {

/// Contrast that text needs on its ground. @see Web Content Accessibility Guidelines 2.1, success criterion 1.4.3.
inline constexpr double kTextContrast = 4.5;

/// Relative luminance of an sRGB colour, 0 (black) .. 1 (white). @see WCAG 2.1, "relative luminance".
inline double luminance(const Colour& c) {
  const auto linear = [](double v) { return v <= 0.03928 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4); };
  return 0.2126 * linear(c[0]) + 0.7152 * linear(c[1]) + 0.0722 * linear(c[2]);
}

/// (L1 + 0.05) / (L2 + 0.05) of the brighter over the darker: 1 .. 21. @see WCAG 2.1, "contrast ratio".
inline double contrast(const Colour& a, const Colour& b) {
  const double la = luminance(a), lb = luminance(b);
  return (std::max(la, lb) + 0.05) / (std::min(la, lb) + 0.05);
}

/// The colour, moved towards white on a dark ground and towards black on a light one as far as text needs; its hue stays.
inline Colour readableOn(const Colour& ground, Colour colour, double least = kTextContrast) {
  const double end = contrast({1, 1, 1}, ground) > contrast({0, 0, 0}, ground) ? 1 : 0;
  constexpr int kSteps = 64;  // finer than 8 bits after the first few
  for (int i = 0; i < kSteps && contrast(colour, ground) < least; ++i)
    for (double& v : colour) v += 0.05 * (end - v);
  return colour;
}

}  // namespace glint::draw
