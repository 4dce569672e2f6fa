// SPDX-License-Identifier: BSD-3-Clause
#include "gui/base/eliding_delegate.h"

#include <QAbstractItemView>
#include <QHelpEvent>
#include <QToolTip>
#include <QTreeView>
#include <algorithm>

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

QSize WrappingDelegate::sizeHint(const QStyleOptionViewItem& option, const QModelIndex& index) const {
  const auto* tree = qobject_cast<const QTreeView*>(option.widget);
  if (!tree) return QStyledItemDelegate::sizeHint(option, index);
  int depth = tree->rootIsDecorated() ? 1 : 0;
  for (QModelIndex parent = index.parent(); parent.isValid(); parent = parent.parent()) ++depth;
  QStyleOptionViewItem wrapped = option;
  wrapped.features |= QStyleOptionViewItem::WrapText;
  wrapped.rect = QRect(0, 0, std::max(1, tree->columnWidth(index.column()) - depth * tree->indentation()), 1);
  return QStyledItemDelegate::sizeHint(wrapped, index);
}

}  // namespace glint::gui
