// SPDX-License-Identifier: BSD-3-Clause
#include "gui/explain/paint_picture.h"

#include <QFontMetricsF>
#include <QPainter>
#include <QPolygonF>

#include "gui/base/text.h"
#include "gui/base/theme.h"

namespace glint::gui {

namespace {
Qt::PenStyle penStyle(draw::Dash dash) {
  switch (dash) {
    case draw::Dash::Solid: return Qt::SolidLine;
    case draw::Dash::Dashed: return Qt::DashLine;
    case draw::Dash::DashDotted: return Qt::DashDotLine;
    case draw::Dash::Dotted: break;
  }
  return Qt::DotLine;
}
}  // namespace

void paintPicture(QPainter& painter, const viz::DrawnPicture& picture, const QFont& font) {
  painter.setRenderHint(QPainter::Antialiasing);
  QFont strong = font;
  strong.setBold(true);
  for (const auto& line : picture.lines) {
    QPolygonF points;
    for (const Eigen::Vector2d& p : line.points) points << QPointF(p.x(), p.y());
    QColor colour = toQColor(line.colour);
    if (line.filled) {
      colour.setAlphaF(line.opacity);
      painter.setPen(Qt::NoPen);
      painter.setBrush(colour);
      painter.drawPolygon(points);
      continue;
    }
    painter.setBrush(Qt::NoBrush);
    painter.setPen(QPen(colour, line.width, penStyle(line.dash), Qt::RoundCap, Qt::RoundJoin));
    painter.drawPolyline(points);
  }
  for (const auto& dot : picture.dots) {
    painter.setPen(Qt::NoPen);
    painter.setBrush(toQColor(dot.colour));
    painter.drawEllipse(QPointF(dot.at.x(), dot.at.y()), dot.radius, dot.radius);
  }
  for (const auto& text : picture.texts) {
    painter.setFont(text.strong ? strong : font);
    painter.setPen(toQColor(text.colour));
    const QString s = toQString(text.text);
    const double w = QFontMetricsF(painter.font()).horizontalAdvance(s);
    const double x = text.at.x() - (text.align == draw::Align::Left ? 0 : text.align == draw::Align::Centre ? w / 2 : w);
    painter.drawText(QPointF(x, text.at.y()), s);
  }
}

}  // namespace glint::gui
