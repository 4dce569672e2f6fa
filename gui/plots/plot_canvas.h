// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QPointF>
#include <QWidget>
#include <optional>

#include "core/draw/plot_view.h"
#include "gui/plots/plot_cursor.h"

namespace glint::gui {

/// Shows one plot. Hover tells a sample's value, a click selects it, the wheel zooms along x (with Ctrl along both), dragging
/// moves what is zoomed, a double click shows everything again. By keyboard: the arrow keys, Home and End go from point to point,
/// Enter selects one, and Esc gives it up; where one brushes, Shift extends the brush.
class PlotCanvas : public QWidget {
  Q_OBJECT
 public:
  explicit PlotCanvas(QWidget* parent = nullptr);
  QSize sizeHint() const override { return {520, 260}; }
  QSize minimumSizeHint() const override { return {220, 130}; }

  void show(const draw::PlotData& plot);
  void setSelection(const draw::Selection& selection);
  /// Instead of the samples of the selection.
  void setMarked(const std::vector<draw::PlotSample>& samples);
  const draw::PlotData& plot() const;
  draw::PlotStyle style() const;
  void showAll();
  /// Dragging marks a rectangle and reports its content; with Shift it moves the zoomed part. A click beside the samples marks
  /// none.
  void setBrushing(bool brushing) { brushing_ = brushing; }
  /// Where a sample is drawn, in this widget's coordinates; empty if it is not.
  std::optional<QPointF> positionOf(const draw::PlotSample& sample) const;
  void renderNow() { repaint(); }

 signals:
  void clicked(const draw::PlotTarget& target);
  void brushed(const std::vector<draw::PlotSample>& samples);
  void touched();  ///< pressed anywhere: this is the plot that actions are about

 protected:
  void paintEvent(QPaintEvent* e) override;
  void mousePressEvent(QMouseEvent* e) override;
  void mouseMoveEvent(QMouseEvent* e) override;
  void mouseReleaseEvent(QMouseEvent* e) override;
  void mouseDoubleClickEvent(QMouseEvent* e) override;
  void wheelEvent(QWheelEvent* e) override;
  void leaveEvent(QEvent* e) override;
  void keyPressEvent(QKeyEvent* e) override;
  void focusInEvent(QFocusEvent* e) override;
  bool event(QEvent* e) override;

 private:
  void scheduleRender();
  std::optional<draw::PlotSample> sampleAt(const QPointF& at) const;
  void hover(const QPointF& at, const QPoint& global);
  std::vector<draw::PlotSample> samplesIn(const QRectF& box) const;
  PlotCursor::Where places() const;
  bool takes(const QKeyEvent& e) const;  ///< a key that goes about in the plot
  void tellCursor();
  void drawCursor(QPainter& painter) const;

  draw::PlotView view_;
  std::optional<draw::PlotSample> hovered_;
  QPointF pressed_, last_;
  PlotCursor cursor_;
  bool byKeys_ = false;  ///< the brush was made by keys
  bool dragging_ = false, held_ = false, brushing_ = false, moves_ = false;
};

}  // namespace glint::gui
