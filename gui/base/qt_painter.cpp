// SPDX-License-Identifier: BSD-3-Clause
#include "gui/base/qt_painter.h"

#include <QFontMetricsF>
#include <QPainter>
#include <QPainterPath>
#include <QPolygonF>
#include <algorithm>
#include <cmath>

#include "core/draw/painter.h"
#include "gui/base/text.h"
#include "gui/base/theme.h"

namespace glint::gui {

QtPainter::QtPainter(QPainter& painter) : painter_(painter), font_(painter.font()) {
  painter_.setRenderHint(QPainter::Antialiasing);
  painter_.setBrush(Qt::NoBrush);
}

void QtPainter::fill(const draw::Box& box, const draw::Colour& colour, double opacity) {
  if (!(box.width > 0) || !(box.height > 0)) return;
  QColor ink = toQColor(colour);
  ink.setAlphaF(opacity);
  painter_.fillRect(QRectF(box.x, box.y, box.width, box.height), ink);
}

void QtPainter::stroke(const std::vector<Eigen::Vector2d>& points, bool closed, const draw::Colour& colour, double widthPx,
                       draw::Dash dash, const draw::Box& clip) {
  QPen pen(toQColor(colour), widthPx, Qt::SolidLine, Qt::FlatCap, Qt::RoundJoin);
  if (dash == draw::Dash::Dashed) pen.setDashPattern({4, 3});
  if (dash == draw::Dash::Dotted) pen.setDashPattern({1, 2});
  if (dash == draw::Dash::DashDotted) pen.setDashPattern({5, 2, 1, 2});
  for (const draw::Chain& chain : draw::chainsInside(points, closed, clip)) {
    QPolygonF polygon;
    polygon.reserve(int(chain.points.size()));
    for (const Eigen::Vector2d& p : chain.points) polygon << QPointF(p.x(), p.y());
    QPainterPath path;
    path.addPolygon(polygon);
    if (chain.closed) path.closeSubpath();
    painter_.strokePath(path, pen);
  }
}

void QtPainter::disc(const Eigen::Vector2d& centre, double radius, const draw::Colour& colour) {
  painter_.setPen(Qt::NoPen);
  painter_.setBrush(toQColor(colour));
  painter_.drawEllipse(QPointF(centre.x(), centre.y()), radius, radius);
  painter_.setBrush(Qt::NoBrush);
}

void QtPainter::ring(const Eigen::Vector2d& centre, double radius, const draw::Colour& colour, double widthPx,
                     const draw::Box& clip) {
  const bool whole = !(clip.width > 0) || (centre.x() - radius >= clip.x && centre.x() + radius <= clip.x + clip.width &&
                                           centre.y() - radius >= clip.y && centre.y() + radius <= clip.y + clip.height);
  if (!whole) return Painter::ring(centre, radius, colour, widthPx, clip);
  painter_.setPen(QPen(toQColor(colour), widthPx));
  painter_.drawEllipse(QPointF(centre.x(), centre.y()), radius, radius);
}

QFont QtPainter::fontOf(double sizePx, bool bold) const {
  QFont font = font_;
  font.setPixelSize(std::max(1, int(std::lround(sizePx))));
  font.setBold(bold);
  return font;
}

void QtPainter::text(const Eigen::Vector2d& at, const std::string& text, double sizePx, const draw::Colour& colour,
                     draw::Align align, bool vertical, bool bold) {
  if (text.empty()) return;
  const double width = textWidth(text, sizePx, bold);
  const double start = align == draw::Align::Left ? 0 : align == draw::Align::Centre ? -0.5 * width : -width;
  painter_.save();
  painter_.setFont(fontOf(sizePx, bold));
  painter_.setPen(toQColor(colour));
  painter_.translate(at.x(), at.y());
  if (vertical) painter_.rotate(-90);
  painter_.drawText(QPointF(start, 0), toQString(text));
  painter_.restore();
}

double QtPainter::textWidth(const std::string& text, double sizePx, bool bold) const {
  return QFontMetricsF(fontOf(sizePx, bold)).horizontalAdvance(toQString(text));
}

}  // namespace glint::gui
