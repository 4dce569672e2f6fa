// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QDoubleSpinBox>
#include <cmath>

#include "core/base/settings.h"

namespace glint::gui {

/// A spin box for one number: writes it as short as it is ("1e-10", not 0.0000000001) and with a point in every locale, reads
/// what numberFromText reads, and changes its value only when typing is finished. If the typed text is wrong, it says
/// why, below the box, and keeps its value. It shows about five digits, so that the unit stays in sight, and all of them while it
/// is edited and in its tool tip; what is shown shortened stays exact unless it is changed.
class NumberBox : public QDoubleSpinBox {
  Q_OBJECT
 public:
  explicit NumberBox(const ParamSpec& spec, QWidget* parent = nullptr);
  /// The value of a box that takes whole numbers only, see wholeRange().
  int whole() const { return int(std::lround(value())); }
  /// What is wrong with a text that was typed; "" = nothing.
  QString problemOf(const QString& text) const;
  QString textFromValue(double value) const override;
  double valueFromText(const QString& text) const override;
  QValidator::State validate(QString& text, int& position) const override;
  void fixup(QString& text) const override;
  QSize sizeHint() const override;  ///< room for the longest number that it shows, and the unit
  QSize minimumSizeHint() const override { return sizeHint(); }

 protected:
  bool event(QEvent* e) override;
  bool eventFilter(QObject* watched, QEvent* e) override;
  void focusInEvent(QFocusEvent* e) override;
  void focusOutEvent(QFocusEvent* e) override;

 private:
  void setFull(bool full);
  bool full_ = false;   ///< shows all digits
  bool whole_ = false;  ///< takes whole numbers only
};

/// The range of a number box that belongs to no setting.
ParamSpec numberRange(double min, double max, double step);
ParamSpec wholeRange(int min, int max);

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
