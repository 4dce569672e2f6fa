// SPDX-License-Identifier: BSD-3-Clause
#include "viz/overlay_clip.h"

#include <algorithm>
#include <utility>

namespace glint::viz {
namespace {

/// From where to where, as shares of its length, a segment lies in the box; nothing when it does not.
/// @see Liang & Barsky, A New Concept and Method for Line Clipping, 1984.
std::optional<std::pair<double, double>> inside(const Pixel& a, const Pixel& b, const Eigen::AlignedBox2d& box) {
  double from = 0, to = 1;
  for (int i = 0; i < 2; ++i) {
    const double d = b[i] - a[i];
    if (d == 0) {
      if (a[i] < box.min()[i] || a[i] > box.max()[i]) return {};
      continue;
    }
    const double t0 = (box.min()[i] - a[i]) / d, t1 = (box.max()[i] - a[i]) / d;
    from = std::max(from, std::min(t0, t1));
    to = std::min(to, std::max(t0, t1));
  }
  if (!(from <= to)) return {};
  return std::pair(from, to);
}

}  // namespace

FrameOverlay cutTo(const FrameOverlay& overlay, const Eigen::AlignedBox2d& box) {
  FrameOverlay cut = overlay;
  cut.lines.clear();
  for (const OverlayLine& line : overlay.lines) {
    if (std::all_of(line.points.begin(), line.points.end(), [&](const Pixel& p) { return box.contains(p); })) {
      cut.lines.push_back(line);
      continue;
    }
    OverlayLine piece = line;
    piece.closed = false;
    piece.points.clear();
    const auto finish = [&] {
      if (piece.points.size() > 1) cut.lines.push_back(piece);
      piece.points.clear();
    };
    const std::size_t n = line.points.size();
    for (std::size_t i = 0; i + (line.closed ? 0 : 1) < n; ++i) {
      const Pixel &a = line.points[i], &b = line.points[(i + 1) % n];
      const auto part = inside(a, b, box);
      if (!part) continue;  // the piece before it ended at the border
      if (piece.points.empty()) piece.points.push_back(a + part->first * (b - a));
      piece.points.push_back(a + part->second * (b - a));
      if (part->second < 1) finish();
    }
    finish();
  }
  cut.marks.erase(std::remove_if(cut.marks.begin(), cut.marks.end(), [&](const OverlayMark& m) { return !box.contains(m.at); }),
                  cut.marks.end());
  return cut;
}

}  // namespace glint::viz
