// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QWidget>

#include "gui/explain/walk_player.h"

class QLabel;
class QSlider;
class QToolButton;

namespace glint::gui {

/// The walk in section, S beside T, with its chart, play button and slider.
class WalkView : public QWidget {
  Q_OBJECT
 public:
  WalkView(Document& document, WalkPlayer& player, QWidget* parent = nullptr);
  QSize sizeHint() const override { return {360, 280}; }

 protected:
  void changeEvent(QEvent* e) override;

 private:
  class Picture;
  void refresh();

  Document& document_;
  WalkPlayer& player_;
  Picture* picture_;
  QToolButton* play_;
  QSlider* slider_;
  QLabel* where_;
  int gesture_ = 0;
};

}  // namespace glint::gui
