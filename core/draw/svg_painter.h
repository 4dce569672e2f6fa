// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/draw/painter.h"

namespace glint::draw {

/// Paints into SVG 1.1. Texts stay texts, in DejaVu Sans or what the reader has for it, stretched to the width that DejaVu Sans
/// would take (`textLength`), so that the layout is the same everywhere. Lines are cut by this class: readers and converters
/// disagree about clip paths. Numbers have a decimal point whatever the locale; texts are escaped.
class SvgPainter : public Painter {
 public:
  /// @param background  none: transparent
  SvgPainter(double width, double height, const std::optional<Colour>& background = std::nullopt);
  void fill(const Box& box, const Colour& colour, double opacity = 1) override;
  void stroke(const std::vector<Eigen::Vector2d>& points, bool closed, const Colour& colour, double widthPx,
              Dash dash = Dash::Solid, const Box& clip = {}) override;
  void disc(const Eigen::Vector2d& centre, double radius, const Colour& colour) override;
  void text(const Eigen::Vector2d& at, const std::string& text, double sizePx, const Colour& colour, Align align = Align::Left,
            bool vertical = false, bool bold = false) override;
  double textWidth(const std::string& text, double sizePx, bool bold = false) const override;
  /// A `title` that the reader shows under the mouse.
  void hint(const Eigen::Vector2d& centre, double radius, const std::string& text) override;
  /// An encoded image, stretched over a box; its pixels stay squares. @param mime  "image/png"
  void picture(const std::vector<unsigned char>& encoded, const std::string& mime, const Box& box);

  /// For an HTML page. @param label  what a screen reader says
  std::string element(const std::string& label) const;
  /// For a file of its own. @param description  longer than the title; "" = none
  std::string document(const std::string& title, const std::string& description = "") const;

 private:
  std::string open(const std::string& attributes) const;
  double width_, height_;
  std::string body_, hints_;  // hints on top: they answer the mouse
};

}  // namespace glint::draw
