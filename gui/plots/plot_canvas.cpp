// SPDX-License-Identifier: BSD-3-Clause
#include "gui/plots/plot_canvas.h"

#include <QAccessible>
#include <QKeyEvent>
#include <QMouseEvent>
#include <QPainter>
#include <QToolTip>
#include <QWheelEvent>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "gui/base/draw_turns.h"
#include "gui/base/focus_frame.h"
#include "gui/base/picture_access.h"
#include "gui/base/qt_painter.h"
#include "gui/base/text.h"
#include "gui/base/theme.h"
#include "gui/base/tips.h"

namespace glint::gui {

namespace {
constexpr double kReachPx = 10;     // of a click or the mouse, screen px
constexpr double kDragPx = 4;       // a press that moves further is a drag
constexpr double kCursorPx = 8;     // radius of the ring around the point that the keyboard is at
constexpr double kWheelStep = 1.2;  // zoom of one notch

Eigen::Vector2d placeOf(const QPointF& at) { return {at.x(), at.y()}; }

/// Each series with the range of its values.
QString plotWords(const draw::PlotData& plot) {
  if (!plot.empty.empty()) return toQString(plot.title + ": " + plot.empty);
  QStringList words{toQString(plot.title)};
  for (const draw::PlotSeries& series : plot.series) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const draw::PlotPoint& p : series.points)
      if (std::isfinite(p.y)) low = std::min(low, p.y), high = std::max(high, p.y);
    if (series.name.empty() || !(low <= high)) continue;
    words << QObject::tr("%1: %2 from %3 to %4")
                 .arg(toQString(series.name), toQString(plot.y.title), numberText(low), numberText(high));
  }
  return words.join(QStringLiteral("; "));
}
}  // namespace

PlotCanvas::PlotCanvas(QWidget* parent) : QWidget(parent) {
  setMouseTracking(true);
  setAttribute(Qt::WA_OpaquePaintEvent);
  setFocusPolicy(Qt::TabFocus);  // a click leaves the arrow keys where they are
  new FocusFrame(this);
  describePicture(this, tr("Plot"), [this] {
    const std::string at = cursor_.words(view_.plot(), places());
    return plotWords(view_.plot()) + (at.empty() ? QString() : tr(". At point %1").arg(toQString(at)));
  });
}

const draw::PlotData& PlotCanvas::plot() const { return view_.plot(); }
draw::PlotStyle PlotCanvas::style() const { return {currentTheme() == Theme::Dark, 1}; }  // Qt scales to the device's pixels

void PlotCanvas::paintEvent(QPaintEvent*) {
  QPainter painter(this);
  QtPainter into(painter);
  view_.setStyle(style());
  view_.paint(into, width(), height());
  if (hasFocus()) drawCursor(painter);
  if (!brushing_ || !dragging_ || moves_) return;
  QColor colour = palette().color(QPalette::Highlight);
  painter.setPen(colour);
  colour.setAlpha(50);
  painter.setBrush(colour);
  painter.drawRect(QRectF(pressed_, last_).normalized());
}

std::vector<draw::PlotSample> PlotCanvas::samplesIn(const QRectF& box) const {
  std::vector<draw::PlotSample> samples;
  for (int s = 0; s < int(plot().series.size()); ++s)
    for (int i = 0; i < int(plot().series[std::size_t(s)].points.size()); ++i)
      if (const std::optional<QPointF> at = positionOf({s, i}); at && box.contains(*at)) samples.push_back({s, i});
  return samples;
}

/// In a turn of its own: several views that change at once must not make the interface stand still together.
void PlotCanvas::scheduleRender() {
  drawInTurn(this, [this] {
    if (isVisible()) repaint();
  });
}

void PlotCanvas::show(const draw::PlotData& plot) {
  hovered_.reset();
  view_.show(plot);
  scheduleRender();
}

void PlotCanvas::setSelection(const draw::Selection& selection) {
  view_.setSelection(selection);
  scheduleRender();
}

void PlotCanvas::setMarked(const std::vector<draw::PlotSample>& samples) {
  view_.setMarked(samples);
  scheduleRender();
}

void PlotCanvas::showAll() {
  view_.showAll();
  update();
}

std::optional<QPointF> PlotCanvas::positionOf(const draw::PlotSample& sample) const {
  const std::optional<Eigen::Vector2d> at = view_.positionOf(sample);
  if (!at) return std::nullopt;
  return QPointF(at->x(), at->y());
}

std::optional<draw::PlotSample> PlotCanvas::sampleAt(const QPointF& at) const { return view_.at(placeOf(at), kReachPx); }

void PlotCanvas::hover(const QPointF& at, const QPoint& global) {
  const std::optional<draw::PlotSample> sample = sampleAt(at);
  if (sample == hovered_) return;
  hovered_ = sample;
  view_.setHovered(sample);
  update();
  setCursor(sample ? Qt::PointingHandCursor : Qt::ArrowCursor);
  if (sample)
    showTip(global, toQString(plot().series[std::size_t(sample->series)].points[std::size_t(sample->point)].label), this);
  else
    QToolTip::hideText();
}

void PlotCanvas::mousePressEvent(QMouseEvent* e) {
  emit touched();
  pressed_ = last_ = e->localPos();
  held_ = e->button() == Qt::LeftButton;
  dragging_ = false;
  moves_ = !brushing_ || e->modifiers() & Qt::ShiftModifier;
}

void PlotCanvas::mouseMoveEvent(QMouseEvent* e) {
  if (!held_) return hover(e->localPos(), e->globalPos());
  dragging_ = dragging_ || (e->localPos() - pressed_).manhattanLength() >= kDragPx;
  if (!dragging_) return;
  if (moves_) view_.pan(placeOf(e->localPos() - last_));
  last_ = e->localPos();
  update();
}

void PlotCanvas::mouseReleaseEvent(QMouseEvent* e) {
  const bool click = held_ && !dragging_, box = held_ && dragging_ && !moves_;
  held_ = dragging_ = false;
  if (box) {
    update();
    emit brushed(samplesIn(QRectF(pressed_, e->localPos()).normalized()));
  }
  if (!click) return;
  if (const std::optional<draw::PlotSample> sample = sampleAt(e->localPos()))
    emit clicked(plot().series[std::size_t(sample->series)].points[std::size_t(sample->point)].target);
  else if (brushing_)
    emit brushed({});
}

void PlotCanvas::mouseDoubleClickEvent(QMouseEvent*) { showAll(); }

void PlotCanvas::wheelEvent(QWheelEvent* e) {
  view_.zoom(std::pow(kWheelStep, e->angleDelta().y() / 120.0), placeOf(e->position()), e->modifiers() & Qt::ControlModifier);
  update();
  e->accept();
}

void PlotCanvas::leaveEvent(QEvent*) {
  hovered_.reset();
  view_.setHovered({});
  update();
}

// --- by keyboard ----------------------------------------------------------------------------------------------------------

PlotCursor::Where PlotCanvas::places() const {
  return [this](const draw::PlotSample& sample) { return positionOf(sample); };
}

bool PlotCanvas::takes(const QKeyEvent& e) const {
  if (e.modifiers() & ~(Qt::ShiftModifier | Qt::KeypadModifier)) return false;
  switch (e.key()) {
    case Qt::Key_Left:
    case Qt::Key_Right:
    case Qt::Key_Up:
    case Qt::Key_Down:
    case Qt::Key_Home:
    case Qt::Key_End: return true;
    case Qt::Key_Return:
    case Qt::Key_Enter:
    case Qt::Key_Escape: return cursor_.any() || byKeys_;  // else Esc stops computations
    default: return false;
  }
}

void PlotCanvas::keyPressEvent(QKeyEvent* e) {
  if (!takes(*e)) return QWidget::keyPressEvent(e);
  using Step = PlotCursor::Step;
  if (e->key() == Qt::Key_Escape) {
    cursor_.clear();
    if (std::exchange(byKeys_, false)) emit brushed({});
    return tellCursor();
  }
  if (e->key() == Qt::Key_Return || e->key() == Qt::Key_Enter) {
    if (const std::optional<draw::PlotSample> sample = cursor_.sample(plot()))
      emit clicked(plot().series[std::size_t(sample->series)].points[std::size_t(sample->point)].target);
    return;
  }
  const Step step = e->key() == Qt::Key_Home                             ? Step::First
                    : e->key() == Qt::Key_End                            ? Step::Last
                    : e->key() == Qt::Key_Left || e->key() == Qt::Key_Up ? Step::Previous
                                                                         : Step::Next;
  const bool extend = brushing_ && e->modifiers().testFlag(Qt::ShiftModifier);
  if (!cursor_.move(plot(), places(), step, extend)) return;
  if (extend) {
    byKeys_ = true;
    emit brushed(cursor_.range(plot(), places()));
  }
  tellCursor();
}

void PlotCanvas::tellCursor() {
  update();
  QAccessibleEvent changed(this, QAccessible::DescriptionChanged);
  QAccessible::updateAccessibility(&changed);
  const std::optional<draw::PlotSample> sample = cursor_.sample(plot());
  const std::optional<QPointF> at = sample ? positionOf(*sample) : std::nullopt;
  if (!at) return QToolTip::hideText();
  showTip(mapToGlobal(at->toPoint()),
          toQString(plot().series[std::size_t(sample->series)].points[std::size_t(sample->point)].label), this);
}

void PlotCanvas::drawCursor(QPainter& painter) const {
  const std::optional<draw::PlotSample> sample = cursor_.sample(plot());
  const std::optional<QPointF> at = sample ? positionOf(*sample) : std::nullopt;
  if (!at) return;
  painter.setRenderHint(QPainter::Antialiasing);
  painter.setBrush(Qt::NoBrush);
  painter.setPen(QPen(focusColour(), 2));
  painter.drawEllipse(*at, kCursorPx, kCursorPx);
}

void PlotCanvas::focusInEvent(QFocusEvent* e) {
  emit touched();
  QWidget::focusInEvent(e);
}

bool PlotCanvas::event(QEvent* e) {
  if (e->type() == QEvent::ShortcutOverride && takes(*static_cast<QKeyEvent*>(e))) {
    e->accept();
    return true;
  }
  if (e->type() == QEvent::ToolTip) return true;  // hover() shows them
  return QWidget::event(e);
}

}  // namespace glint::gui
