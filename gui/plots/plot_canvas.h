// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QPointF>
#include <QWidget>
#include <memory>
#include <optional>

#include "viz/plots/plot_view.h"

namespace glint::gui {

class VtkCanvas;

/// Shows one plot. Hover tells a sample's value, a click selects it, the wheel zooms along x (with Ctrl along both), dragging
/// moves what is zoomed, a double click shows everything again.
class PlotCanvas : public QWidget {
  Q_OBJECT
 public:
  explicit PlotCanvas(QWidget* parent = nullptr);
  ~PlotCanvas() override;
  QSize sizeHint() const override { return {520, 260}; }
  QSize minimumSizeHint() const override { return {220, 130}; }

  void show(const viz::PlotData& plot);
  void setSelection(const viz::Selection& selection);
  const viz::PlotData& plot() const;
  viz::PlotStyle style() const;
  void showAll();
  /// Where a sample is drawn, in this widget's coordinates; empty when it is not.
  std::optional<QPointF> positionOf(const viz::PlotSample& sample) const;
  void renderNow();
  QWidget* surface() const;  ///< what takes the mouse

 signals:
  void clicked(const viz::PlotTarget& target);
  void touched();  ///< pressed anywhere: this is the plot that actions are about

 protected:
  bool eventFilter(QObject* watched, QEvent* event) override;
  void showEvent(QShowEvent* e) override;
  void changeEvent(QEvent* e) override;

 private:
  void scheduleRender();
  std::optional<viz::PlotSample> sampleAt(const QPointF& at) const;
  void hover(const QPointF& at, const QPoint& global);

  VtkCanvas* widget_;
  std::unique_ptr<viz::PlotView> view_;
  std::optional<viz::PlotSample> hovered_;
  QPointF pressed_, last_;
  bool dragging_ = false, held_ = false;
};

}  // namespace glint::gui
