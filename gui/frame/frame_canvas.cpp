// SPDX-License-Identifier: BSD-3-Clause
#include "gui/frame/frame_canvas.h"

#include <QApplication>
#include <QMouseEvent>
#include <QPainter>
#include <QPainterPath>
#include <QWheelEvent>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "gui/base/theme.h"

namespace glint::gui {

namespace {
constexpr double kMinZoom = 0.02, kMaxZoom = 512;
constexpr double kGridFromZoom = 16;  // below this the pixel grid would hide the photograph
const QColor kHalo(0, 0, 0, 170);

QPointF positionOf(const QMouseEvent& e) {
#if QT_VERSION >= QT_VERSION_CHECK(6, 0, 0)
  return e.position();
#else
  return e.localPos();
#endif
}

QPen penOf(const viz::OverlayLine& line, const QColor& colour, double width) {
  QPen pen(colour, width, Qt::SolidLine, Qt::FlatCap, Qt::RoundJoin);
  if (line.dash == viz::Dash::Dashed) pen.setDashPattern({4, 3});
  if (line.dash == viz::Dash::Dotted) pen.setDashPattern({1, 2});
  return pen;
}
}  // namespace

FrameCanvas::FrameCanvas(QWidget* parent) : QWidget(parent) {
  setMouseTracking(true);
  setFocusPolicy(Qt::StrongFocus);
  setAttribute(Qt::WA_OpaquePaintEvent);
}

void FrameCanvas::setPhotograph(const QImage& photograph) {
  const bool sameSize = photograph.size() == photograph_.size();
  photograph_ = photograph;
  develop();
  message_.clear();
  if (fitted_ || !sameSize) fit();
  update();
}

void FrameCanvas::setMessage(const QString& message) {
  message_ = message;
  photograph_ = shown_ = QImage();
  update();
}

void FrameCanvas::setOverlay(viz::FrameOverlay overlay) {
  overlay_ = std::move(overlay);
  update();
}

void FrameCanvas::setExposure(double stops) {
  if (stops == exposure_) return;
  exposure_ = stops;
  develop();
  update();
}

void FrameCanvas::develop() {
  if (exposure_ == 0 || photograph_.isNull()) {
    shown_ = photograph_;
    return;
  }
  // Stops are factors of two of linear light, so the sRGB curve is undone and done again.
  std::array<uchar, 256> table{};
  const double gain = std::exp2(exposure_);
  for (int i = 0; i < 256; ++i) {
    const double v = i / 255.0;
    const double light = std::min(1.0, gain * (v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4)));
    const double back = light <= 0.0031308 ? 12.92 * light : 1.055 * std::pow(light, 1 / 2.4) - 0.055;
    table[std::size_t(i)] = uchar(std::lround(255 * std::clamp(back, 0.0, 1.0)));
  }
  shown_ = photograph_.convertToFormat(QImage::Format_RGB888);
  for (int y = 0; y < shown_.height(); ++y) {
    uchar* row = shown_.scanLine(y);
    for (int i = 0; i < 3 * shown_.width(); ++i) row[i] = table[row[i]];
  }
}

void FrameCanvas::setStale(bool stale) {
  stale_ = stale;
  update();
}

QPointF FrameCanvas::widgetFromPixel(const Pixel& p) const {
  return {corner_.x() + (p.x() + 0.5) * zoom_, corner_.y() + (p.y() + 0.5) * zoom_};
}

Pixel FrameCanvas::pixelFromWidget(const QPointF& w) const {
  return {(w.x() - corner_.x()) / zoom_ - 0.5, (w.y() - corner_.y()) / zoom_ - 0.5};
}

void FrameCanvas::setZoom(double zoom, const QPointF& anchor) {
  const Pixel kept = pixelFromWidget(anchor);
  zoom_ = std::clamp(zoom, kMinZoom, kMaxZoom);
  corner_ += anchor - widgetFromPixel(kept);
  fitted_ = false;
  emit zoomChanged(zoom_);
  update();
}

void FrameCanvas::lookAt(const Pixel& pixel, double zoom) {
  zoom_ = std::clamp(zoom, kMinZoom, kMaxZoom);
  corner_ += QRectF(rect()).center() - widgetFromPixel(pixel);
  fitted_ = false;
  emit zoomChanged(zoom_);
  update();
}

void FrameCanvas::fit() {
  fitted_ = true;
  if (photograph_.isNull() || width() < 1 || height() < 1) return;
  zoom_ =
      std::clamp(std::min(double(width()) / photograph_.width(), double(height()) / photograph_.height()), kMinZoom, kMaxZoom);
  corner_ = QPointF((width() - zoom_ * photograph_.width()) / 2, (height() - zoom_ * photograph_.height()) / 2);
  emit zoomChanged(zoom_);
  update();
}

void FrameCanvas::onePixelPerPixel() { setZoom(1 / devicePixelRatioF(), QRectF(rect()).center()); }

void FrameCanvas::paintEvent(QPaintEvent*) {
  QPainter painter(this);
  painter.fillRect(rect(), palette().color(QPalette::Dark));
  if (photograph_.isNull()) {
    painter.setPen(palette().color(QPalette::PlaceholderText));
    painter.drawText(rect().adjusted(16, 16, -16, -16), Qt::AlignCenter | Qt::TextWordWrap, message_);
  } else {
    drawPhotograph(painter);
  }
  drawOverlay(painter);
  if (stale_) {
    const QString text = tr("updating…");
    const QRect chip = QRect(QPoint(8, 8), painter.fontMetrics().size(0, text) + QSize(14, 6));
    painter.setRenderHint(QPainter::Antialiasing);
    painter.setPen(Qt::NoPen);
    painter.setBrush(QColor(0, 0, 0, 170));
    painter.drawRoundedRect(chip, 4, 4);
    painter.setPen(QColor(0xf0, 0xc0, 0x50));
    painter.drawText(chip, Qt::AlignCenter, text);
  }
}

void FrameCanvas::drawPhotograph(QPainter& painter) const {
  // Only the visible part is drawn: at high zoom the whole photograph would be scaled to millions of pixels.
  const Pixel from = pixelFromWidget({0, 0}), to = pixelFromWidget(QPointF(width(), height()));
  const QRect visible = QRect(QPoint(int(std::floor(from.x())), int(std::floor(from.y()))),
                              QPoint(int(std::ceil(to.x())) + 1, int(std::ceil(to.y())) + 1))
                            .intersected(photograph_.rect());
  if (visible.isEmpty()) return;
  const QRectF target(widgetFromPixel({visible.x() - 0.5, visible.y() - 0.5}), QSizeF(visible.size()) * zoom_);
  painter.setRenderHint(QPainter::SmoothPixmapTransform, zoom_ * devicePixelRatioF() < 1.999);
  painter.drawImage(target, shown_, QRectF(visible));
  if (zoom_ < kGridFromZoom) return;
  painter.setPen(QPen(QColor(128, 128, 128, 70), 0));
  for (int x = visible.left(); x <= visible.right() + 1; ++x) {
    const double w = widgetFromPixel({x - 0.5, 0}).x();
    painter.drawLine(QPointF(w, target.top()), QPointF(w, target.bottom()));
  }
  for (int y = visible.top(); y <= visible.bottom() + 1; ++y) {
    const double h = widgetFromPixel({0, y - 0.5}).y();
    painter.drawLine(QPointF(target.left(), h), QPointF(target.right(), h));
  }
}

void FrameCanvas::drawOverlay(QPainter& painter) const {
  painter.setRenderHint(QPainter::Antialiasing);
  painter.setBrush(Qt::NoBrush);
  for (const viz::OverlayLine& line : overlay_.lines) {
    if (line.points.size() < 2) continue;
    QPolygonF polygon;
    polygon.reserve(int(line.points.size()));
    for (const Pixel& p : line.points) polygon << widgetFromPixel(p);
    QPainterPath path;
    path.addPolygon(polygon);
    if (line.closed) path.closeSubpath();
    if (line.halo) painter.strokePath(path, penOf(line, kHalo, line.width + 2));
    painter.strokePath(path, penOf(line, toQColor(line.colour), line.width));
  }
  for (const viz::OverlayMark& mark : overlay_.marks) {
    const QPointF at = widgetFromPixel(mark.at);
    const auto draw = [&](const QColor& colour, double width) {
      painter.setPen(QPen(colour, width));
      if (mark.shape == viz::MarkShape::Circle) {
        painter.drawEllipse(at, mark.size, mark.size);
      } else {
        painter.drawLine(at - QPointF(mark.size, 0), at + QPointF(mark.size, 0));
        painter.drawLine(at - QPointF(0, mark.size), at + QPointF(0, mark.size));
      }
    };
    if (mark.halo) draw(kHalo, mark.width + 2);
    draw(toQColor(mark.colour), mark.width);
  }
}

void FrameCanvas::resizeEvent(QResizeEvent*) {
  if (fitted_) fit();
}

void FrameCanvas::wheelEvent(QWheelEvent* e) {
  setZoom(zoom_ * std::pow(2.0, e->angleDelta().y() / 240.0), e->position());
  e->accept();
}

void FrameCanvas::mousePressEvent(QMouseEvent* e) {
  pressed_ = last_ = positionOf(*e);
  dragging_ = false;
}

void FrameCanvas::mouseMoveEvent(QMouseEvent* e) {
  const QPointF at = positionOf(*e);
  if (e->buttons() & (Qt::LeftButton | Qt::MiddleButton)) {
    if ((at - pressed_).manhattanLength() >= QApplication::startDragDistance()) dragging_ = true;
    if (dragging_) {
      corner_ += at - last_;
      fitted_ = false;
      setCursor(Qt::ClosedHandCursor);
      update();
    }
  }
  last_ = at;
  probe(at);
}

void FrameCanvas::mouseReleaseEvent(QMouseEvent* e) {
  unsetCursor();
  if (!dragging_ && e->button() == Qt::LeftButton && !photograph_.isNull()) {
    const Pixel p = pixelFromWidget(positionOf(*e));
    emit clicked(p.x(), p.y());
  }
  dragging_ = false;
}

void FrameCanvas::mouseDoubleClickEvent(QMouseEvent*) { fit(); }
void FrameCanvas::leaveEvent(QEvent*) { emit probed(QString()); }

void FrameCanvas::probe(const QPointF& position) {
  const Pixel p = pixelFromWidget(position);
  const QPoint index(int(std::lround(p.x())), int(std::lround(p.y())));
  if (!photograph_.valid(index)) {
    emit probed(QString());
    return;
  }
  const QColor c = photograph_.pixelColor(index);
  emit probed(
      tr("x %1  y %2   sRGB %3 %4 %5").arg(p.x(), 0, 'f', 2).arg(p.y(), 0, 'f', 2).arg(c.red()).arg(c.green()).arg(c.blue()));
}

}  // namespace glint::gui
