// SPDX-License-Identifier: BSD-3-Clause
#include "core/draw/painter.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <sstream>
#include <utility>

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
  std::vector<std::size_t> ends;  // of its beginnings in whole UTF-8 characters
  for (std::size_t i = 0; i < text.size(); ++i)
    if ((static_cast<unsigned char>(text[i]) & 0xC0) != 0x80) ends.push_back(i);
  const auto shortened = [&](std::size_t end) { return text.substr(0, end) + "\u2026"; };
  // Longer beginnings are wider: a text of a file may have a million letters.
  const auto tooWide = std::partition_point(ends.begin(), ends.end(),
                                            [&](std::size_t end) { return textWidth(shortened(end), sizePx) <= widthPx; });
  return tooWide == ends.begin() ? std::string() : shortened(*std::prev(tooWide));
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

namespace {
constexpr double kCaptionMargin = 0.7;   // of the letters' size, on every side: as between two paragraphs of a paper
constexpr double kCaptionLeading = 1.3;  // of the letters' size, from line to line: the usual one of running text
constexpr double kCaptionAscent = 0.95;  // of the letters' size, above the first baseline: DejaVu Sans has 0.93
}  // namespace

Caption captionOf(const Painter& painter, const std::string& text, double sizePx, double width, double mostHeight) {
  Caption caption;
  const double room = width - 2 * kCaptionMargin * sizePx;
  const double most = std::floor((mostHeight / sizePx - 2 * kCaptionMargin) / kCaptionLeading);
  if (!(room > 0) || !(most >= 1)) return caption;
  std::vector<std::string> lines = painter.wrapped(text, sizePx, room);
  if (double(lines.size()) > most) {
    lines.resize(std::size_t(most));
    lines.back() += " \u2026";
    while (painter.textWidth(lines.back(), sizePx) > room && lines.back().find(' ') != lines.back().rfind(' '))
      lines.back() = lines.back().substr(0, lines.back().rfind(' ', lines.back().rfind(' ') - 1)) + " \u2026";
  }
  if (lines.empty()) return caption;
  for (const std::string& line : lines) caption.lines.push_back(painter.fitted(line, sizePx, room));
  caption.sizePx = sizePx;
  caption.height = (double(lines.size()) * kCaptionLeading + 2 * kCaptionMargin) * sizePx;
  return caption;
}

void paintCaption(Painter& painter, const Caption& caption, double top, const Colour& ink) {
  double baseline = top + (kCaptionMargin + kCaptionAscent) * caption.sizePx;
  for (const std::string& line : caption.lines) {
    painter.text({kCaptionMargin * caption.sizePx, baseline}, line, caption.sizePx, ink);
    baseline += kCaptionLeading * caption.sizePx;
  }
}

namespace {

/// From where to where, as shares of its length, a segment lies in the box; nothing if it does not.
std::optional<std::pair<double, double>> inside(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& low,
                                                const Eigen::Vector2d& high) {
  double from = 0, to = 1;
  for (int i = 0; i < 2; ++i) {
    const double d = b[i] - a[i];
    if (d == 0) {
      if (a[i] < low[i] || a[i] > high[i]) return {};
      continue;
    }
    const double t0 = (low[i] - a[i]) / d, t1 = (high[i] - a[i]) / d;
    from = std::max(from, std::min(t0, t1));
    to = std::min(to, std::max(t0, t1));
  }
  if (!(from <= to)) return {};
  return std::pair(from, to);
}

}  // namespace

std::vector<Chain> chainsInside(const std::vector<Eigen::Vector2d>& points, bool closed, const Box& box) {
  Chain whole;
  whole.closed = closed;
  for (const Eigen::Vector2d& p : points)
    if (p.allFinite()) whole.points.push_back(p);
  const std::size_t n = whole.points.size();
  if (n < 2) return {};
  const Eigen::Vector2d low(box.x, box.y), high(box.x + box.width, box.y + box.height);
  const auto contains = [&](const Eigen::Vector2d& p) {
    return (p.array() >= low.array()).all() && (p.array() <= high.array()).all();
  };
  if (!(box.width > 0) || std::all_of(whole.points.begin(), whole.points.end(), contains)) return {whole};
  std::vector<Chain> chains;
  std::vector<Eigen::Vector2d> piece;
  const auto finish = [&] {
    if (piece.size() > 1) chains.push_back({piece, false});
    piece.clear();
  };
  for (std::size_t i = 0; i + (closed ? 0 : 1) < n; ++i) {
    const Eigen::Vector2d &a = whole.points[i], &b = whole.points[(i + 1) % n];
    const auto part = inside(a, b, low, high);
    if (!part) continue;  // the piece before it ended at the border
    if (piece.empty()) piece.push_back(a + part->first * (b - a));
    piece.push_back(a + part->second * (b - a));
    if (part->second < 1) finish();
  }
  finish();
  return chains;
}

}  // namespace glint::draw
