// SPDX-License-Identifier: BSD-3-Clause
#include "gui/frame/frame_canvas.h"

#include <QApplication>
#include <QHelpEvent>
#include <QLinearGradient>
#include <QMouseEvent>
#include <QPainter>
#include <QToolTip>
#include <QWheelEvent>
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/draw/frame_overlay.h"
#include "gui/base/focus_frame.h"
#include "gui/base/picture_access.h"
#include "gui/base/qt_painter.h"
#include "gui/base/stale_badge.h"
#include "gui/base/text.h"
#include "gui/base/theme.h"
#include "gui/base/tips.h"
#include "gui/frame/pixel_probe.h"
#include "viz/frame_pick.h"

namespace glint::gui {

namespace {
constexpr double kMinZoom = 0.02, kMaxZoom = 512;
constexpr double kGridFromZoom = 16;       // below this the pixel grid would hide the photograph
constexpr int kFigurePhotographPx = 2400;  // an enlarged part is not made larger than this
const QColor kHalo(0, 0, 0, 170);

QPointF positionOf(const QMouseEvent& e) {
#if QT_VERSION >= QT_VERSION_CHECK(6, 0, 0)
  return e.position();
#else
  return e.localPos();
#endif
}

}  // namespace

FrameCanvas::FrameCanvas(QWidget* parent) : QWidget(parent) {
  setMouseTracking(true);
  setFocusPolicy(Qt::StrongFocus);
  new FocusFrame(this);
  setAttribute(Qt::WA_OpaquePaintEvent);
  stale_ = new StaleBadge(this, Qt::BottomRightCorner);
  awaiting_.setSingleShot(true);
  awaiting_.setInterval(StaleBadge::kAfterMs);
  connect(&awaiting_, &QTimer::timeout, this, [this] { update(); });
  describePicture(this, tr("Photograph with contours"), [this] {
    QStringList words;
    for (const QString& text : {message_, caption_, awaited_})
      if (!text.isEmpty()) words << text;
    for (const draw::OverlayCaption& c : overlay_.captions) words << toQString(c.text);
    return words.isEmpty() ? tr("Nothing is shown yet") : words.join(QStringLiteral("; "));
  });
}

void FrameCanvas::setAwaited(const QString& words) {
  if (awaited_.isEmpty()) awaiting_.start();  // while one steps on, the first photograph that is late counts
  awaited_ = words;
  update();
}

void FrameCanvas::setPicture(const FramePicture& picture) {
  const bool sameSize = picture.shown.size() == photograph_.size();
  picture_ = picture;
  compose();
  message_.clear();
  awaited_.clear();
  awaiting_.stop();
  if (fitted_ || !sameSize) fit();
  update();
}

void FrameCanvas::setPhotograph(const QImage& photograph) {
  FramePicture picture;
  picture.shown = photograph;
  setPicture(picture);
}

void FrameCanvas::setMessage(const QString& message) {
  message_ = message;
  awaited_.clear();
  awaiting_.stop();
  picture_ = {};
  compose();
  update();
}

void FrameCanvas::setCompared(const FramePicture& other, int from, const QString& left, const QString& right) {
  if (other.shown.isNull() && other_.shown.isNull()) return;
  other_ = other;
  from_ = from;
  leftName_ = left;
  rightName_ = right;
  const bool sized = !photograph_.isNull();
  compose();
  if (!sized && fitted_) fit();
  update();
}

/// One picture of both, so that zooming and figures need not know of it.
void FrameCanvas::compose() {
  photograph_ = picture_.shown;
  if (other_.shown.isNull()) return;
  if (photograph_.isNull()) {
    photograph_ = other_.shown;
    return;
  }
  if (photograph_.size() != other_.shown.size()) return;
  const int width = photograph_.width(), from = std::clamp(from_, 0, width);
  photograph_ = photograph_.copy();
  QPainter(&photograph_).drawImage(QPoint(from, 0), other_.shown, QRect(from, 0, width - from, photograph_.height()));
}

double FrameCanvas::dividerX() const { return widgetFromPixel({from_ - 0.5, 0}).x(); }

bool FrameCanvas::nearDivider(const QPointF& at) const {
  constexpr double kNearLinePx = 4;
  return comparing() && !picture_.shown.isNull() && std::abs(at.x() - dividerX()) <= kNearLinePx;
}

void FrameCanvas::setOverlay(draw::FrameOverlay overlay) {
  overlay_ = std::move(overlay);
  update();
}

void FrameCanvas::setScale(std::vector<viz::ScaleTick> ticks) {
  scale_ = std::move(ticks);
  update();
}

void FrameCanvas::setHeld(std::vector<Pixel> line, std::optional<Pixel> mark) {
  if (line.empty() && !mark && !showsHeld()) return;
  heldLine_ = std::move(line);
  heldMark_ = mark;
  update();
}

void FrameCanvas::setCaption(const QString& caption) {
  caption_ = caption;
  update();
}

void FrameCanvas::setStale(bool stale) { stale_->setStale(stale); }

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
  draw(painter);
  if (showsHeld()) drawHeld(painter);
}

void FrameCanvas::draw(QPainter& painter) const {
  const bool late = !awaited_.isEmpty() && !awaiting_.isActive();
  if (photograph_.isNull()) {
    painter.setPen(palette().color(QPalette::WindowText));
    painter.drawText(rect().adjusted(16, 16, -16, -16), Qt::AlignCenter | Qt::TextWordWrap, late ? awaited_ : message_);
  } else {
    constexpr double kFaint = 0.3;
    painter.setOpacity(late ? kFaint : 1);
    drawPhotograph(painter);
    painter.setOpacity(1);
    if (late) drawChip(painter, awaited_, caption_.isEmpty() ? 8 : 16 + painter.fontMetrics().height() + 6);
  }
  drawOverlay(painter);
  if (comparing() && !picture_.shown.isNull()) drawDivider(painter);
  if (!photograph_.isNull() && !scale_.empty()) drawScale(painter);
  if (!caption_.isEmpty()) drawChip(painter, caption_, 8);
}

void FrameCanvas::drawFigure(QPainter& painter, const QRectF& target, const QColor& background) const {
  const double scale = std::min(target.width() / std::max(1, width()), target.height() / std::max(1, height()));
  FrameCanvas copy;
  copy.figure_ = true;
  copy.resize(int(std::ceil(target.width() / scale)), int(std::ceil(target.height() / scale)));
  copy.picture_ = picture_;
  copy.photograph_ = photograph_;
  copy.other_ = other_;
  copy.from_ = from_;
  copy.leftName_ = leftName_;
  copy.rightName_ = rightName_;
  copy.scale_ = scale_;
  copy.message_ = message_;
  copy.caption_ = caption_;
  if (fitted_)
    copy.fit();
  else
    copy.lookAt(centre(), zoom_);
  copy.overlay_ = overlay_;
  painter.save();
  painter.setClipRect(target);
  if (background.isValid()) painter.fillRect(target, background);
  painter.translate(target.topLeft());
  painter.scale(scale, scale);
  painter.setFont(font());
  copy.draw(painter);
  painter.restore();
}

void FrameCanvas::drawHeld(QPainter& painter) const {
  painter.setRenderHint(QPainter::Antialiasing);
  QPolygonF line;
  for (const Pixel& p : heldLine_) line << widgetFromPixel(p);
  for (const auto& [colour, width] : {std::pair(kHalo, 4.0), std::pair(accentColour(), 2.0)}) {
    painter.setPen(QPen(colour, width));
    painter.setBrush(Qt::NoBrush);
    painter.drawPolygon(line);
    if (heldMark_) painter.drawEllipse(widgetFromPixel(*heldMark_), kNearScreenPx, kNearScreenPx);
  }
}

void FrameCanvas::drawChip(QPainter& painter, const QString& text, int top) const {
  drawChip(painter, text, QRect({8, top}, painter.fontMetrics().size(0, text) + QSize(14, 6)));
}

void FrameCanvas::drawDivider(QPainter& painter) const {
  const double x = dividerX();
  const QPointF top(x, std::max(0.0, corner_.y())),
      bottom(x, std::min(double(height()), corner_.y() + zoom_ * photograph_.height()));
  painter.setRenderHint(QPainter::Antialiasing);
  for (const auto& [colour, width] : {std::pair(kHalo, 3.0), std::pair(QColor(Qt::white), 1.0)}) {
    painter.setPen(QPen(colour, width));
    painter.drawLine(top, bottom);
  }
  constexpr int kBeside = 6;
  const auto sizeOf = [&](const QString& text) { return painter.fontMetrics().size(0, text) + QSize(14, 6); };
  const int y = std::min(height(), int(bottom.y())) - sizeOf(leftName_).height() - 8;
  const QRect left(QPoint(int(x) - kBeside - sizeOf(leftName_).width(), y), sizeOf(leftName_));
  const QRect right(QPoint(int(x) + kBeside, y), sizeOf(rightName_));
  if (left.left() >= 0 && left.right() < width()) drawChip(painter, leftName_, left);
  if (right.left() >= 0 && right.right() < width()) drawChip(painter, rightName_, right);
}

void FrameCanvas::drawChip(QPainter& painter, const QString& text, const QRect& chip) const {
  painter.setRenderHint(QPainter::Antialiasing);
  painter.setPen(Qt::NoPen);
  painter.setBrush(QColor(0, 0, 0, 170));
  painter.drawRoundedRect(chip, 4, 4);
  painter.setPen(Qt::white);
  painter.drawText(chip, Qt::AlignCenter, text);
}

void FrameCanvas::drawScale(QPainter& painter) const {
  const auto& colours = viz::uniformColours();
  const int text = painter.fontMetrics().height();
  const QString title = picture_.kind == viz::Values::Linearised ? tr("linear") : tr("radiance");
  const auto widthOf = [&](const QString& words) { return painter.fontMetrics().horizontalAdvance(words); };
  int numbers = 0;
  for (const viz::ScaleTick& tick : scale_) numbers = std::max(numbers, widthOf(QString::fromStdString(tick.text)));
  const int wide = std::max(8 + 12 + 5 + numbers, 6 + widthOf(title)) + 6;
  const QRectF box(width() - 10 - wide, 10, wide, std::min(180, height() - 20));
  if (box.height() < 4 * text) return;
  painter.setRenderHint(QPainter::Antialiasing);
  painter.setPen(Qt::NoPen);
  painter.setBrush(QColor(0, 0, 0, 170));
  painter.drawRoundedRect(box, 4, 4);
  painter.setPen(Qt::white);
  painter.drawText(QRectF(box.left(), box.top() + 2, box.width(), text), Qt::AlignCenter, title);
  const QRectF bar(box.left() + 8, box.top() + text + 10, 12, box.height() - text - 20);
  QLinearGradient gradient(bar.bottomLeft(), bar.topLeft());
  for (int i = 0; i < 256; i += 15)
    gradient.setColorAt(i / 255.0, QColor(colours[std::size_t(i)][0], colours[std::size_t(i)][1], colours[std::size_t(i)][2]));
  painter.fillRect(bar, gradient);
  for (const viz::ScaleTick& tick : scale_) {
    const double y = bar.bottom() - tick.place * bar.height();
    painter.drawLine(QPointF(bar.right(), y), QPointF(bar.right() + 3, y));
    painter.drawText(QRectF(bar.right() + 5, y - text / 2.0, numbers + 1, text), Qt::AlignLeft | Qt::AlignVCenter,
                     QString::fromStdString(tick.text));
  }
}

void FrameCanvas::drawValues(QPainter& painter, const QRect& visible) const {
  const int from = comparing() ? (picture_.shown.isNull() ? 0 : from_) : visible.right() + 1;
  drawValues(painter, picture_, QRect(visible.topLeft(), QPoint(std::min(visible.right(), from - 1), visible.bottom())));
  drawValues(painter, other_, QRect(QPoint(std::max(visible.left(), from), visible.top()), visible.bottomRight()));
}

void FrameCanvas::drawValues(QPainter& painter, const FramePicture& of, const QRect& visible) const {
  if (!of.values || !of.developed || visible.isEmpty()) return;
  QFont small = font();
  small.setPixelSize(std::clamp(int(zoom_ / 4.6), 9, 18));
  painter.setFont(small);
  for (const viz::PixelText& text :
       viz::pixelTexts(*of.values, of.kind, *of.developed, visible.left(), visible.top(), visible.right(), visible.bottom())) {
    QStringList lines;
    for (const std::string& line : text.lines) lines << QString::fromStdString(line);
    painter.setPen(text.dark ? QColor(0, 0, 0, 200) : QColor(255, 255, 255, 200));
    painter.drawText(QRectF(widgetFromPixel({text.x - 0.5, text.y - 0.5}), QSizeF(zoom_, zoom_)), Qt::AlignCenter,
                     lines.join(QLatin1Char('\n')));
  }
  painter.setFont(font());
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
  if (figure_) {
    // Large pixels stay squares even if the reader of the file would smooth them.
    const int enlarge = zoom_ < 2 ? 1 : std::clamp(kFigurePhotographPx / std::max(visible.width(), visible.height()), 1, 16);
    const QImage part = photograph_.copy(visible);
    painter.drawImage(target, enlarge == 1 ? part : part.scaled(part.size() * enlarge));
  } else {
    painter.drawImage(target, photograph_, QRectF(visible));
  }
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
  if (zoom_ >= kValuesFromZoom) drawValues(painter, visible);
}

void FrameCanvas::drawOverlay(QPainter& painter) const {
  constexpr double kBeside = 4;  // px: strokes that are cut at the border do not end within sight
  const double beside = figure_ ? 0 : kBeside;
  const draw::Box box{-beside, -beside, width() + 2 * beside, height() + 2 * beside};
  const Pixel from = pixelFromWidget({box.x, box.y}), to = pixelFromWidget({box.x + box.width, box.y + box.height});
  QtPainter into(painter);
  draw::paintOverlay(into, overlay_, {from.x(), from.y(), to.x() - from.x(), to.y() - from.y()}, box);
}

void FrameCanvas::resizeEvent(QResizeEvent*) {
  if (fitted_) fit();
}

void FrameCanvas::wheelEvent(QWheelEvent* e) {
  setZoom(zoom_ * std::pow(2.0, e->angleDelta().y() / 240.0), e->position());
  emit viewMoved();
  e->accept();
}

void FrameCanvas::mousePressEvent(QMouseEvent* e) {
  pressed_ = last_ = positionOf(*e);
  dragging_ = false;
  dividing_ = e->button() == Qt::LeftButton && nearDivider(pressed_);
  divides_ = false;
  held_ = !dividing_ && tool_ && e->button() == Qt::LeftButton && !photograph_.isNull() &&
          tool_->take(pixelFromWidget(pressed_), kNearScreenPx / zoom_, e->modifiers());
}

void FrameCanvas::mouseMoveEvent(QMouseEvent* e) {
  const QPointF at = positionOf(*e);
  if (e->buttons() & (Qt::LeftButton | Qt::MiddleButton)) {
    if ((at - pressed_).manhattanLength() >= QApplication::startDragDistance()) dragging_ = true;
    if (dragging_ && dividing_) {
      setCursor(Qt::SplitHCursor);
      const double share = (pixelFromWidget(at).x() + 0.5) / photograph_.width();
      emit dividerMoved(std::clamp(share, 0.0, 1.0), !std::exchange(divides_, true));
    } else if (dragging_) {
      setCursor(Qt::ClosedHandCursor);
      if (held_) {
        tool_->carry(pixelFromWidget(at));
      } else {
        corner_ += at - last_;
        fitted_ = false;
        update();
        emit viewMoved();
      }
    }
  } else if (nearDivider(at)) {
    setCursor(Qt::SplitHCursor);
  } else if (!tool_) {
    unsetCursor();
  } else {
    if (tool_->wouldTake(pixelFromWidget(at), kNearScreenPx / zoom_, e->modifiers()))
      setCursor(Qt::OpenHandCursor);
    else
      unsetCursor();
  }
  last_ = at;
  probe(at);
}

void FrameCanvas::mouseReleaseEvent(QMouseEvent* e) {
  unsetCursor();
  if (std::exchange(held_, false)) tool_->release();
  dividing_ = false;
  if (!dragging_ && e->button() == Qt::LeftButton && !photograph_.isNull()) {
    const Pixel p = pixelFromWidget(positionOf(*e));
    emit clicked(p.x(), p.y());
  }
  dragging_ = false;
}

void FrameCanvas::mouseDoubleClickEvent(QMouseEvent*) {
  fit();
  emit viewMoved();
}

bool FrameCanvas::event(QEvent* e) {
  if (e->type() != QEvent::ToolTip) return QWidget::event(e);
  const auto* help = static_cast<QHelpEvent*>(e);
  const std::string label = viz::labelAt(overlay_, pixelFromWidget(help->pos()), kNearScreenPx / zoom_);
  if (label.empty())
    QToolTip::hideText();
  else
    showTip(help->globalPos(), toQString(label), this);
  return true;
}

void FrameCanvas::leaveEvent(QEvent*) { emit probed(QString()); }

void FrameCanvas::probe(const QPointF& position) {
  const Pixel p = pixelFromWidget(position);
  const QPoint index(int(std::lround(p.x())), int(std::lround(p.y())));
  if (!photograph_.valid(index)) {
    emit probed(QString());
    return;
  }
  QString values;
  if (const FramePicture& shown = pictureAt(index.x()); shown.values) {
    values = QString::fromStdString(viz::valueText(*shown.values, shown.kind, index.x(), index.y()));
  } else {
    const QColor c = photograph_.pixelColor(index);
    values = tr("sRGB %1 %2 %3").arg(c.red()).arg(c.green()).arg(c.blue());
  }
  emit probed(probeText(p, values, nullptr));
  emit hovered(p.x(), p.y());
}

}  // namespace glint::gui
