// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QScrollArea>

namespace glint::gui {

/// Holds a panel, and gives it scroll bars where there is less room than it needs, so that it demands little of the window and
/// nothing of it is cut. Unlike a resizable QScrollArea it asks a layout that wraps for its least height, not for its best.
class PanelScroll : public QScrollArea {
  Q_OBJECT
 public:
  /// Fills: takes all the room that there is. Hugs: as high as its content, and less where that is too much.
  enum class Height { Fills, Hugs };
  /// @param least  what it demands at most, px.
  PanelScroll(QWidget* content, QSize least, Height height = Height::Fills);
  QSize minimumSizeHint() const override;
  QSize sizeHint() const override;
  /// Limits the height of a panel that hugs its content, px; the rest scrolls.
  void setMost(int height);

 protected:
  bool event(QEvent* event) override;
  bool eventFilter(QObject* watched, QEvent* event) override;
  void resizeEvent(QResizeEvent* event) override;

 private:
  int heightFor(int width, bool least) const;
  void fit();
  QSize least_;
  Height height_;
  int most_ = QWIDGETSIZE_MAX;
};

}  // namespace glint::gui
