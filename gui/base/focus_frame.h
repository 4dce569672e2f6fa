// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QWidget>

namespace glint::gui {

/// A thin frame over a picture while it has the focus by the keyboard; a style draws none there. Belongs to its widget.
class FocusFrame : public QWidget {
  Q_OBJECT
 public:
  explicit FocusFrame(QWidget* of);

 protected:
  bool eventFilter(QObject* watched, QEvent* event) override;
  void paintEvent(QPaintEvent*) override;

 private:
  bool byKeyboard_ = false;  ///< also while the window is not the active one
};

}  // namespace glint::gui
