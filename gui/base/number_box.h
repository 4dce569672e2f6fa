// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QDoubleSpinBox>

#include "core/base/settings.h"

namespace glint::gui {

/// A spin box for one numeric setting: writes numbers as short as they are ("1e-10", not 0.0000000001), accepts both, and changes
/// its value only when typing is finished. It shows about five digits, so that the unit stays in sight, and all of them while it
/// is edited and in its tool tip; what is shown shortened stays exact unless it is changed. The wheel changes it only while it
/// has the focus, so that scrolling the panel changes nothing.
class NumberBox : public QDoubleSpinBox {
  Q_OBJECT
 public:
  explicit NumberBox(const ParamSpec& spec, QWidget* parent = nullptr);
  QString textFromValue(double value) const override;
  double valueFromText(const QString& text) const override;
  QValidator::State validate(QString& text, int& position) const override;
  QSize sizeHint() const override;  ///< room for the longest number that it shows, and the unit
  QSize minimumSizeHint() const override { return sizeHint(); }

 protected:
  bool event(QEvent* e) override;
  void focusInEvent(QFocusEvent* e) override;
  void focusOutEvent(QFocusEvent* e) override;
  void wheelEvent(QWheelEvent* e) override;

 private:
  void setFull(bool full);
  bool full_ = false;  ///< shows all digits
};

/// Slider positions 0..1000 of a setting: linear, or logarithmic in steps where the range spans many of them.
class SliderScale {
 public:
  static constexpr int kPositions = 1000;
  explicit SliderScale(const ParamSpec& spec);
  int position(double value) const;
  double value(int position) const;  ///< a whole number of steps from the minimum; the ends are exact

 private:
  double min_, max_, step_;
  bool logarithmic_;
};

}  // namespace glint::gui
