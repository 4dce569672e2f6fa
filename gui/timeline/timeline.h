// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QTimer>
#include <QWidget>

#include "gui/base/actions.h"
#include "gui/document/document.h"
#include "gui/timeline/timeline_strip.h"

class QComboBox;
class QScrollBar;
class QToolButton;

namespace glint::gui {

/// The strip with its controls: step, play, speed, the name of the plotted model, lines or bars, and a scroll bar while zoomed.
/// Options "timeline/speed" (frames per second), "timeline/chart" (lines, bars), "timeline/thumbnails" (on, off).
class Timeline : public QWidget {
  Q_OBJECT
 public:
  explicit Timeline(Document& document, QWidget* parent = nullptr);
  TimelineStrip* strip() const { return strip_; }
  bool playing() const { return clock_.isActive(); }
  bool busy() const { return strip_->thumbnails().busy(); }
  void addActions(Actions& actions, QMenu* menu);

 public slots:
  void setPlaying(bool playing);

 signals:
  void playingChanged(bool playing);

 private:
  void refresh();
  void showView();
  void changeSpeed(int steps);
  void stepToRole(FrameRole role, int by);
  void setBars(bool bars);

  Document& document_;
  TimelineStrip* strip_;
  QScrollBar* scroll_;
  QComboBox *model_, *speed_;
  QToolButton* bars_;
  QAction *barsAction_ = nullptr, *thumbnailsAction_ = nullptr;
  QTimer clock_;
};

}  // namespace glint::gui
