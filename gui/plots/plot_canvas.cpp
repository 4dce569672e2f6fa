// SPDX-License-Identifier: BSD-3-Clause
#include "gui/plots/plot_canvas.h"

#include <vtkGenericOpenGLRenderWindow.h>
#include <vtkNew.h>
#include <vtkRenderer.h>

#include <QMouseEvent>
#include <QToolTip>
#include <QVBoxLayout>
#include <QWheelEvent>
#include <cmath>

#include "gui/base/draw_turns.h"
#include "gui/base/text.h"
#include "gui/base/theme.h"
#include "gui/base/tips.h"
#include "gui/base/vtk_canvas.h"

namespace glint::gui {

namespace {
constexpr double kReachPx = 10;     // of a click or the mouse, screen px
constexpr double kDragPx = 4;       // a press that moves further is a drag
constexpr double kWheelStep = 1.2;  // zoom of one notch
}  // namespace

PlotCanvas::PlotCanvas(QWidget* parent) : QWidget(parent), widget_(new VtkCanvas), view_(std::make_unique<viz::PlotView>()) {
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(0, 0, 0, 0);
  layout->addWidget(widget_);
  widget_->renderWindow()->SetMultiSamples(8);
  widget_->setTextScaled(false);  // the plot scales its text itself
  widget_->renderWindow()->AddRenderer(view_->renderer());
  widget_->installEventFilter(this);
}

PlotCanvas::~PlotCanvas() {
  widget_->removeEventFilter(this);
  widget_->renderWindow()->RemoveRenderer(view_->renderer());
}

QWidget* PlotCanvas::surface() const { return widget_; }
const viz::PlotData& PlotCanvas::plot() const { return view_->plot(); }
viz::PlotStyle PlotCanvas::style() const { return {currentTheme() == Theme::Dark, devicePixelRatioF()}; }

void PlotCanvas::renderNow() {
  view_->setStyle(style());
  widget_->renderNow();
}

void PlotCanvas::scheduleRender() {
  drawInTurn(this, [this] {
    if (widget_->isVisible()) renderNow();
  });
}

void PlotCanvas::show(const viz::PlotData& plot) {
  hovered_.reset();
  view_->setStyle(style());
  view_->show(plot);
  scheduleRender();
}

void PlotCanvas::setSelection(const viz::Selection& selection) {
  view_->setSelection(selection);
  scheduleRender();
}

void PlotCanvas::showAll() {
  view_->showAll();
  scheduleRender();
}

std::optional<QPointF> PlotCanvas::positionOf(const viz::PlotSample& sample) const {
  const std::optional<Eigen::Vector2d> at = view_->positionOf(sample);
  if (!at) return std::nullopt;
  const double ratio = devicePixelRatioF();
  return QPointF(at->x() / ratio, at->y() / ratio);
}

std::optional<viz::PlotSample> PlotCanvas::sampleAt(const QPointF& at) const {
  const double ratio = devicePixelRatioF();
  return view_->at({at.x() * ratio, at.y() * ratio}, kReachPx * ratio);
}

void PlotCanvas::hover(const QPointF& at, const QPoint& global) {
  const std::optional<viz::PlotSample> sample = sampleAt(at);
  if (sample == hovered_) return;
  hovered_ = sample;
  view_->setHovered(sample);
  scheduleRender();
  widget_->setCursor(sample ? Qt::PointingHandCursor : Qt::ArrowCursor);
  if (sample)
    showTip(global, toQString(plot().series[std::size_t(sample->series)].points[std::size_t(sample->point)].label), widget_);
  else
    QToolTip::hideText();
}

bool PlotCanvas::eventFilter(QObject* watched, QEvent* event) {
  if (watched != widget_) return QWidget::eventFilter(watched, event);
  const double ratio = devicePixelRatioF();
  switch (event->type()) {
    case QEvent::MouseButtonPress: {
      const auto* mouse = static_cast<QMouseEvent*>(event);
      emit touched();
      pressed_ = last_ = mouse->localPos();
      held_ = mouse->button() == Qt::LeftButton;
      dragging_ = false;
      return true;
    }
    case QEvent::MouseMove: {
      const auto* mouse = static_cast<QMouseEvent*>(event);
      if (!held_) return hover(mouse->localPos(), mouse->globalPos()), true;
      dragging_ = dragging_ || (mouse->localPos() - pressed_).manhattanLength() >= kDragPx;
      if (dragging_) {
        const QPointF by = mouse->localPos() - last_;
        last_ = mouse->localPos();
        view_->pan({by.x() * ratio, by.y() * ratio});
        scheduleRender();
      }
      return true;
    }
    case QEvent::MouseButtonRelease: {
      const auto* mouse = static_cast<QMouseEvent*>(event);
      const bool click = held_ && !dragging_;
      held_ = false;
      if (click)
        if (const std::optional<viz::PlotSample> sample = sampleAt(mouse->localPos()))
          emit clicked(plot().series[std::size_t(sample->series)].points[std::size_t(sample->point)].target);
      return true;
    }
    case QEvent::MouseButtonDblClick:
      showAll();
      return true;
    case QEvent::Wheel: {
      const auto* wheel = static_cast<QWheelEvent*>(event);
      const double notches = wheel->angleDelta().y() / 120.0;
      view_->zoom(std::pow(kWheelStep, notches), {wheel->position().x() * ratio, wheel->position().y() * ratio},
                  wheel->modifiers() & Qt::ControlModifier);
      scheduleRender();
      return true;
    }
    case QEvent::Leave:
      hovered_.reset();
      view_->setHovered({});
      scheduleRender();
      return false;
    case QEvent::KeyPress:
    case QEvent::KeyRelease:
      event->ignore();  // the window's shortcuts; VTK's own keys mean nothing here
      return true;
    case QEvent::ToolTip:
      return true;  // hover() shows them
    default:
      return false;
  }
}

void PlotCanvas::showEvent(QShowEvent* e) {
  QWidget::showEvent(e);
  scheduleRender();
}

void PlotCanvas::changeEvent(QEvent* e) {
  QWidget::changeEvent(e);
  if (e->type() == QEvent::PaletteChange || e->type() == QEvent::StyleChange) scheduleRender();
}

}  // namespace glint::gui
