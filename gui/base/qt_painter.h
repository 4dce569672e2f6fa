// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QFont>

#include "core/draw/painter.h"

class QPainter;

namespace glint::gui {

/// Paints charts and overlays with a QPainter, on screen or into SVG and PDF. Lines are cut at their box here: Qt's vector
/// formats know no clipping. Texts have the font of the QPainter. Pen, brush and font of the QPainter change.
class QtPainter : public draw::Painter {
 public:
  explicit QtPainter(QPainter& painter);
  void fill(const draw::Box& box, const draw::Colour& colour, double opacity = 1) override;
  void stroke(const std::vector<Eigen::Vector2d>& points, bool closed, const draw::Colour& colour, double widthPx,
              draw::Dash dash = draw::Dash::Solid, const draw::Box& clip = {}) override;
  void disc(const Eigen::Vector2d& centre, double radius, const draw::Colour& colour) override;
  void ring(const Eigen::Vector2d& centre, double radius, const draw::Colour& colour, double widthPx,
            const draw::Box& clip = {}) override;
  void text(const Eigen::Vector2d& at, const std::string& text, double sizePx, const draw::Colour& colour,
            draw::Align align = draw::Align::Left, bool vertical = false, bool bold = false) override;
  double textWidth(const std::string& text, double sizePx, bool bold = false) const override;

 private:
  QFont fontOf(double sizePx, bool bold) const;
  QPainter& painter_;
  QFont font_;
};

}  // namespace glint::gui
