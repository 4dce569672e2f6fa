// SPDX-License-Identifier: BSD-3-Clause
#include "viz/label_places.h"

#include <algorithm>

namespace glint::viz {
namespace {
constexpr double kBeside = 0.8;       // heights of the text between a point and its label
constexpr double kBesideGlyph = 0.4;  // between what is drawn at the point, which has its own edge, and the label
constexpr double kBeforeTip = 0.3;    // between the tip of an arrow and its letter
constexpr double kLeastArrow = 2;     // px: of a shorter one the direction means nothing

bool keepsOff(const Rectangle& r, const std::vector<Rectangle>& others) {
  return std::none_of(others.begin(), others.end(), [&](const Rectangle& other) { return r.overlaps(other); });
}
}  // namespace

std::optional<Rectangle> placeForLabel(const Eigen::Vector2d& at, const Eigen::Vector2d& size, const Eigen::Vector2d& picture,
                                       double font, const std::vector<Rectangle>& taken, const std::vector<Rectangle>& glyphs,
                                       double clear) {
  const auto placed = [&](double x, double y) {
    return Rectangle{std::clamp(x, 2.0, std::max(2.0, picture.x() - size.x() - 4)),
                     std::clamp(y, 2.0, std::max(2.0, picture.y() - size.y() - 4)), size.x(), size.y()};
  };
  const auto isFree = [&](const Rectangle& r) {
    // Pushed in from the picture's edge, it must not cover its own point.
    const double m = 0.75 * font;
    const bool onPoint = r.x - m < at.x() && at.x() < r.x + r.width + m && r.y - m < at.y() && at.y() < r.y + r.height + m;
    return !onPoint && keepsOff(r, taken);
  };
  constexpr int kRows = 8;   // farther, a label would not be seen as its point's
  constexpr int kAside = 3;  // rows: going farther off the cameras, it would seem to be that of another one
  const double aside = std::max(kBeside * font, clear > 0 ? clear + kBesideGlyph * font : 0);
  std::optional<Rectangle> onAGlyph;
  for (int row = 0; row <= kRows; ++row) {
    for (const double side : {1.0, -1.0}) {
      for (const double x : {at.x() + aside, at.x() - aside - size.x()}) {
        const Rectangle r = placed(x, at.y() + 0.3 * font + side * row * (size.y() + 3));
        if (!isFree(r)) continue;
        if (row <= kAside && keepsOff(r, glyphs)) return r;
        if (row > kAside && onAGlyph) return onAGlyph;
        if (!onAGlyph) onAGlyph = r;
      }
    }
  }
  return onAGlyph;
}

std::optional<Rectangle> placeAtTip(const Eigen::Vector2d& tip, const Eigen::Vector2d& arrow, const Eigen::Vector2d& size,
                                    const Eigen::Vector2d& picture, double font, const std::vector<Rectangle>& taken) {
  if (!(arrow.norm() >= kLeastArrow)) return {};
  const Eigen::Vector2d along = arrow.normalized();
  // Along the arrow, the text reaches that far from its middle.
  const double reach = 0.5 * along.cwiseAbs().dot(size);
  const Eigen::Vector2d corner = tip + (kBeforeTip * font + reach) * along - 0.5 * size;
  const Rectangle r{corner.x(), corner.y(), size.x(), size.y()};
  const bool inside = r.x >= 0 && r.y >= 0 && r.x + r.width <= picture.x() && r.y + r.height <= picture.y();
  return inside && keepsOff(r, taken) ? std::optional(r) : std::nullopt;
}

}  // namespace glint::viz
