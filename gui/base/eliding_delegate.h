// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QStyledItemDelegate>

namespace glint::gui {

/// For lists in narrow docks: a row is as wide as the list, its text ends in "…" where it does not fit, and the tool tip is then
/// the whole text.
class ElidingDelegate : public QStyledItemDelegate {
  Q_OBJECT
 public:
  using QStyledItemDelegate::QStyledItemDelegate;
  QSize sizeHint(const QStyleOptionViewItem& option, const QModelIndex& index) const override;
  bool helpEvent(QHelpEvent* event, QAbstractItemView* view, const QStyleOptionViewItem& option,
                 const QModelIndex& index) override;
  /// The row's text does not fit into `option.rect`.
  bool isCut(const QStyleOptionViewItem& option, const QModelIndex& index) const;
};

/// For trees of sentences: a row is as high as its text, wrapped at the width that the tree has for it. Qt's own delegate asks
/// for one line, whatever setWordWrap() says, and cuts it.
class WrappingDelegate : public QStyledItemDelegate {
  Q_OBJECT
 public:
  using QStyledItemDelegate::QStyledItemDelegate;
  QSize sizeHint(const QStyleOptionViewItem& option, const QModelIndex& index) const override;
};

}  // namespace glint::gui
