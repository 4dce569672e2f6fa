// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QStyledItemDelegate>

namespace glint::gui {

/// The same with at most so many significant digits in every number that has a decimal point.
QString withDigits(const QString& text, int digits);

/// Shows numbers with fewer digits where a row has no room for all of them: three coordinates stay on one line. What is copied,
/// and the tool tip, keep them.
class NumberDelegate : public QStyledItemDelegate {
  Q_OBJECT
 public:
  using QStyledItemDelegate::QStyledItemDelegate;

 protected:
  void initStyleOption(QStyleOptionViewItem* option, const QModelIndex& index) const override;
};

}  // namespace glint::gui
