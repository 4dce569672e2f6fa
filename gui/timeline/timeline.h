// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QTimer>
#include <QWidget>
#include <optional>
#include <vector>

#include "gui/base/actions.h"
#include "gui/document/document.h"

namespace glint::gui {

/// Strip of all frames: role by colour and shape (training: filled square, held out: ring, excluded: cross), error of the plotted
/// model as bars on an absolute scale, the current frame. Click and drag select; the context menu changes the role; Left and
/// Right step.
class TimelineStrip : public QWidget {
  Q_OBJECT
 public:
  explicit TimelineStrip(Document& document, QWidget* parent = nullptr);
  QRectF cell(int frame) const;                ///< in widget coordinates
  int frameAt(const QPointF& position) const;  ///< -1 outside
  QSize sizeHint() const override { return {600, 84}; }
  QSize minimumSizeHint() const override { return {200, 70}; }

 public slots:
  void step(int by);

 protected:
  void paintEvent(QPaintEvent*) override;
  void mousePressEvent(QMouseEvent*) override;
  void mouseMoveEvent(QMouseEvent*) override;
  void contextMenuEvent(QContextMenuEvent*) override;
  void keyPressEvent(QKeyEvent*) override;
  bool event(QEvent*) override;

 private:
  struct Bar {
    std::optional<double> errorPct;
    QString reason;  ///< why there is no number
  };
  void readErrors();
  QRectF chart() const;

  Document& document_;
  std::vector<Bar> bars_;
  double scalePct_ = 1;  ///< error at the top of the chart
  int gesture_ = 0;
};

/// The strip with its buttons: step, play, and the name of the plotted model.
class Timeline : public QWidget {
  Q_OBJECT
 public:
  explicit Timeline(Document& document, QWidget* parent = nullptr);
  TimelineStrip* strip() const { return strip_; }
  bool playing() const { return clock_.isActive(); }
  void addActions(Actions& actions, QMenu* menu);

 public slots:
  void setPlaying(bool playing);

 signals:
  void playingChanged(bool playing);

 private:
  Document& document_;
  TimelineStrip* strip_;
  QTimer clock_;
  int gesture_ = 0;
};

}  // namespace glint::gui
