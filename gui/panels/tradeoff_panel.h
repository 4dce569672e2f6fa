// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QWidget>

#include "gui/document/document.h"
#include "gui/plots/plot_canvas.h"

class QLabel;
class QPushButton;

namespace glint::gui {

/// Contour error over time per frame of every measured setting (draw::tradeoffPlot). A click on a point loads its model and
/// settings; Left and Right move along the front, Return loads.
class TradeoffPlot : public PlotCanvas {
  Q_OBJECT
 public:
  explicit TradeoffPlot(Document& document, QWidget* parent = nullptr);
  QSize sizeHint() const override { return {600, 240}; }
  QSize minimumSizeHint() const override { return {260, 120}; }
  /// Where a setting (an index into Tradeoff::points) is drawn; empty for one without a finite error.
  std::optional<QPointF> placeOf(int setting) const;
  void load(int setting);
  /// The text in place of a missing plot; empty if there is one.
  QString message() const;
  void setMeasuring(bool measuring);

 protected:
  void keyPressEvent(QKeyEvent* e) override;

 private:
  void refresh();
  void mark();
  std::optional<draw::PlotSample> sampleOf(int setting) const;
  void moveAlongFront(int by);

  Document& document_;
  bool measuring_ = false;
  int current_ = -1;  ///< reached by keys
};

/// The plot with its buttons and the sentence of the choice.
class TradeoffPanel : public QWidget {
  Q_OBJECT
 public:
  explicit TradeoffPanel(Document& document, QWidget* parent = nullptr);
  TradeoffPlot* plot() const { return plot_; }

 public slots:
  void setBusy(bool busy);

 signals:
  void measureRequested();

 private:
  void refresh();

  Document& document_;
  TradeoffPlot* plot_;
  QPushButton* measure_;
  QWidget* presets_;
  QLabel* sentence_;
  bool busy_ = false;
};

}  // namespace glint::gui
