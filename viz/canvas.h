// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/base/image.h"
#include "core/geometry/camera.h"
#include "viz/frame_overlay.h"
#include "viz/style.h"

namespace glint::viz {

/// A rectangle of the canvas, px from the top left.
struct Box {
  double x = 0, y = 0, width = 0, height = 0;
};
/// A part of an image in its own pixels: (x, y) = left and top *edge*, so a whole image is (-0.5, -0.5, w, h).
using Crop = Box;

enum class Align { Left, Centre, Right };

/// An anti-aliased 2D drawing in memory; needs no display. Canvas coordinates: (0, 0) is the top left corner.
class Canvas {
 public:
  /// std::invalid_argument unless 16 <= width, height <= 16384.
  Canvas(int width, int height, const Colour& background);
  ~Canvas();
  int width() const;
  int height() const;
  void fill(const Box& box, const Colour& colour, double opacity = 1);
  /// Part of a 1- or 3-channel image (0..1) stretched over a box; magnified pixels are interpolated. Outside the image: black.
  void picture(const Image& image, const Crop& crop, const Box& box);
  /// A polyline in canvas px, cut at `clip` unless that is empty.
  void stroke(const std::vector<Eigen::Vector2d>& points, bool closed, const Colour& colour, double widthPx,
              Dash dash = Dash::Solid, const Box& clip = {});
  void disc(const Eigen::Vector2d& centre, double radius, const Colour& colour);
  /// One line of text; `at` is the baseline's left end, middle or right end.
  void text(const Eigen::Vector2d& at, const std::string& text, double sizePx, const Colour& colour, Align align = Align::Left,
            bool vertical = false);
  double textWidth(const std::string& text, double sizePx) const;
  /// The text, its end replaced by an ellipsis if it is wider than `widthPx`.
  std::string fitted(const std::string& text, double sizePx, double widthPx) const;
  /// The text in lines that are at most `widthPx` wide, broken at blanks; a single wider word is a line of its own.
  std::vector<std::string> wrapped(const std::string& text, double sizePx, double widthPx) const;
  /// 3 channels, 0..1.
  Image image() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// PNG with 8 bits a channel; parent folders must exist. InputError when it cannot be written; nothing half written stays.
void writePng(const Image& image, const std::string& file);

}  // namespace glint::viz
