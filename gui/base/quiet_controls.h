// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QComboBox>
#include <QSlider>
#include <QWheelEvent>

namespace glint::gui {

/// A combo box that the wheel changes only while it has the focus, so that scrolling a panel changes nothing.
class QuietComboBox : public QComboBox {
 public:
  using QComboBox::QComboBox;

 protected:
  void wheelEvent(QWheelEvent* e) override {
    if (hasFocus())
      QComboBox::wheelEvent(e);
    else
      e->ignore();
  }
};

/// A slider that leaves the wheel to the panel that it lies in.
class QuietSlider : public QSlider {
 public:
  using QSlider::QSlider;

 protected:
  void wheelEvent(QWheelEvent* e) override { e->ignore(); }
};

}  // namespace glint::gui
