// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QLabel>

namespace glint::gui {

/// One line of plain text that ends in "…" where there is too little room; the tool tip, where it has none of its own, is then
/// the whole line.
class ElidedLabel : public QLabel {
 public:
  /// @param leastChars  of average width, that it always has room for.
  explicit ElidedLabel(const QString& text = {}, int leastChars = 6) : QLabel(text), leastChars_(leastChars) {}
  QSize minimumSizeHint() const override;
  bool isCut() const;

 protected:
  bool event(QEvent* event) override;
  void paintEvent(QPaintEvent* event) override;

 private:
  int leastChars_;
};

}  // namespace glint::gui
