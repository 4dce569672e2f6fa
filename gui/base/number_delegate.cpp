// SPDX-License-Identifier: BSD-3-Clause
#include "gui/base/number_delegate.h"

#include <QApplication>
#include <QRegularExpression>
#include <QStyle>

#include "gui/base/text.h"

namespace glint::gui {

QString withDigits(const QString& text, int digits) {
  static const QRegularExpression number(QStringLiteral("-?[0-9]+\\.[0-9]+(?:e[-+]?[0-9]+)?"));
  QString shorter;
  int from = 0;
  for (auto found = number.globalMatch(text); found.hasNext();) {
    const QRegularExpressionMatch match = found.next();
    shorter += text.mid(from, match.capturedStart() - from) + numberText(match.captured().toDouble(), digits);
    from = match.capturedEnd();
  }
  return shorter + text.mid(from);
}

void NumberDelegate::initStyleOption(QStyleOptionViewItem* option, const QModelIndex& index) const {
  QStyledItemDelegate::initStyleOption(option, index);
  constexpr int kMostDigits = 6, kLeastDigits = 3;  // fewer would tell nothing of a position
  // Qt leaves this margin and one pixel at both ends of a row's text.
  const int margin = 2 * (QApplication::style()->pixelMetric(QStyle::PM_FocusFrameHMargin, option, option->widget) + 1);
  const QString all = option->text;
  for (int digits = kMostDigits;
       digits > kLeastDigits && option->fontMetrics.horizontalAdvance(option->text) + margin > option->rect.width(); --digits)
    option->text = withDigits(all, digits - 1);
}

}  // namespace glint::gui
