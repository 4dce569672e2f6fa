// SPDX-License-Identifier: BSD-3-Clause
#include "core/draw/painter.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>

namespace glint::draw {

void Painter::ring(const Eigen::Vector2d& centre, double radius, const Colour& colour, double widthPx, const Box& clip) {
  const int corners = std::clamp(int(std::lround(4 * radius)), 24, 360);
  std::vector<Eigen::Vector2d> points;
  for (int i = 0; i < corners; ++i) {
    const double angle = 2 * std::numbers::pi * i / corners;
    points.push_back(centre + radius * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
  }
  stroke(points, true, colour, widthPx, Dash::Solid, clip);
}

std::string Painter::fitted(const std::string& text, double sizePx, double widthPx) const {
  if (textWidth(text, sizePx) <= widthPx) return text;
  std::string shorter = text;
  while (!shorter.empty()) {
    do {  // whole UTF-8 characters
      const bool continuation = (static_cast<unsigned char>(shorter.back()) & 0xC0) == 0x80;
      shorter.pop_back();
      if (!continuation) break;
    } while (!shorter.empty());
    if (textWidth(shorter + "\u2026", sizePx) <= widthPx) return shorter + "\u2026";
  }
  return {};
}

std::vector<std::string> Painter::wrapped(const std::string& text, double sizePx, double widthPx) const {
  std::vector<std::string> lines;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    const std::string longer = lines.empty() ? word : lines.back() + " " + word;
    if (!lines.empty() && textWidth(longer, sizePx) <= widthPx)
      lines.back() = longer;
    else
      lines.push_back(word);
  }
  return lines;
}

}  // namespace glint::draw
