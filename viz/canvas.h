// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/base/image.h"
#include "core/draw/painter.h"
#include "viz/style.h"

namespace glint::viz {

/// An anti-aliased 2D drawing in memory; needs no display. Canvas coordinates: (0, 0) is the top left corner.
class Canvas : public Painter {
 public:
  /// std::invalid_argument unless 16 <= width, height <= 16384.
  Canvas(int width, int height, const Colour& background);
  ~Canvas() override;
  int width() const;
  int height() const;
  void fill(const Box& box, const Colour& colour, double opacity = 1) override;
  /// Part of a 1- or 3-channel image (0..1) stretched over a box; magnified pixels are interpolated. Outside the image: black.
  void picture(const Image& image, const Crop& crop, const Box& box);
  void stroke(const std::vector<Eigen::Vector2d>& points, bool closed, const Colour& colour, double widthPx,
              Dash dash = Dash::Solid, const Box& clip = {}) override;
  void disc(const Eigen::Vector2d& centre, double radius, const Colour& colour) override;
  void text(const Eigen::Vector2d& at, const std::string& text, double sizePx, const Colour& colour, Align align = Align::Left,
            bool vertical = false, bool bold = false) override;
  double textWidth(const std::string& text, double sizePx, bool bold = false) const override;
  /// 3 channels, 0..1.
  Image image() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// PNG with 8 bits a channel; parent folders must exist. InputError if it cannot be written; nothing half written stays.
void writePng(const Image& image, const std::string& file);

}  // namespace glint::viz
