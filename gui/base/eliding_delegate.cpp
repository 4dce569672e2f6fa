// SPDX-License-Identifier: BSD-3-Clause
#include "gui/base/eliding_delegate.h"

#include <QAbstractItemView>
#include <QHelpEvent>
#include <QToolTip>

#include "gui/base/tips.h"

namespace glint::gui {

QSize ElidingDelegate::sizeHint(const QStyleOptionViewItem& option, const QModelIndex& index) const {
  return {1, QStyledItemDelegate::sizeHint(option, index).height()};
}

bool ElidingDelegate::isCut(const QStyleOptionViewItem& option, const QModelIndex& index) const {
  return QStyledItemDelegate::sizeHint(option, index).width() > option.rect.width();
}

bool ElidingDelegate::helpEvent(QHelpEvent* event, QAbstractItemView* view, const QStyleOptionViewItem& option,
                                const QModelIndex& index) {
  if (event->type() == QEvent::ToolTip && index.isValid() && index.data(Qt::ToolTipRole).toString().isEmpty() &&
      isCut(option, index)) {
    showTip(event->globalPos(), index.data().toString(), view);
    return true;
  }
  return QStyledItemDelegate::helpEvent(event, view, option, index);
}

}  // namespace glint::gui
