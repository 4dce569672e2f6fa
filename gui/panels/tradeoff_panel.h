// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QWidget>
#include <map>

#include "gui/document/document.h"

class QLabel;
class QPushButton;

namespace glint::gui {

/// Contour error over time per frame of every measured setting, both logarithmic, with the front. A click on a point loads its
/// model and settings; Left and Right move along the front, Return loads.
class TradeoffPlot : public QWidget {
  Q_OBJECT
 public:
  explicit TradeoffPlot(Document& document, QWidget* parent = nullptr);
  QSize sizeHint() const override { return {600, 240}; }
  QSize minimumSizeHint() const override { return {260, 120}; }
  /// Where a point is drawn; empty for one without a finite error.
  std::optional<QPointF> positionOf(int point) const;
  /// The point nearest to a place, at most a few pixels away; -1 = none.
  int pointAt(const QPointF& place) const;
  /// Where the names of presets are written, by point: beside it, and never over one another. One without room has none.
  std::map<int, QRectF> presetNames() const;
  void load(int point);
  /// What stands in place of a plot that there is not; empty when there is one.
  QString message() const;
  void setMeasuring(bool measuring);

 protected:
  void paintEvent(QPaintEvent* e) override;
  void mousePressEvent(QMouseEvent* e) override;
  void mouseMoveEvent(QMouseEvent* e) override;
  void leaveEvent(QEvent* e) override;
  void keyPressEvent(QKeyEvent* e) override;
  bool event(QEvent* e) override;

 private:
  struct Axes;
  Axes axes() const;
  void moveAlongFront(int by);

  Document& document_;
  bool measuring_ = false;
  int current_ = -1;  ///< under the mouse or reached by keys
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
