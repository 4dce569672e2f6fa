// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace glint::viz {

/// Px of a picture, y up.
struct Rectangle {
  double x = 0, y = 0, width = 0, height = 0;
  bool overlaps(const Rectangle& other) const {
    return x < other.x + other.width && other.x < x + width && y < other.y + other.height && other.y < y + height;
  }
};

/// The place of a label: beside its point, to the right first, then to the left, then in rows above and below. A place off all
/// `glyphs` is taken before one on some of them, on which it would be hard to read. Nothing if a small picture has no room: a
/// click on the point still tells what it is, texts over one another tell nothing.
/// @param at, size, picture  px: the point, the label's size and the picture's. @param font  height of the text, px.
/// @param taken   must stay free: other labels and what stands still.
/// @param glyphs  should stay free: cameras and lights that are drawn.
/// @param clear   px: what is drawn at the point reaches that far.
std::optional<Rectangle> placeForLabel(const Eigen::Vector2d& at, const Eigen::Vector2d& size, const Eigen::Vector2d& picture,
                                       double font, const std::vector<Rectangle>& taken, const std::vector<Rectangle>& glyphs,
                                       double clear = 0);

/// In front of the tip of an arrow, as far from it at every zoom. Nothing if the arrow is seen from its end, or if that
/// place is taken or out of the picture.
/// @param arrow  px, from its tail to its tip.
std::optional<Rectangle> placeAtTip(const Eigen::Vector2d& tip, const Eigen::Vector2d& arrow, const Eigen::Vector2d& size,
                                    const Eigen::Vector2d& picture, double font, const std::vector<Rectangle>& taken);

}  // namespace glint::viz
