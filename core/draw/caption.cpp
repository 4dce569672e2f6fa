// SPDX-License-Identifier: BSD-3-Clause
#include "core/draw/caption.h"

#include <algorithm>
#include <cmath>

namespace glint::draw {
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

}  // namespace glint::draw
