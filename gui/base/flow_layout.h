// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QLayout>
#include <QList>

namespace glint::gui {

/// Puts widgets side by side and goes on in the next line where the width ends, as words in a text.
class FlowLayout : public QLayout {
 public:
  explicit FlowLayout(int gap = 2) : gap_(gap) {}
  ~FlowLayout() override;
  void addItem(QLayoutItem* item) override { items_.append(item); }
  int count() const override { return int(items_.size()); }
  QLayoutItem* itemAt(int index) const override { return items_.value(index); }
  QLayoutItem* takeAt(int index) override { return index >= 0 && index < count() ? items_.takeAt(index) : nullptr; }
  Qt::Orientations expandingDirections() const override { return {}; }
  bool hasHeightForWidth() const override { return true; }
  int heightForWidth(int width) const override { return arrange({0, 0, width, 0}, false); }
  void setGeometry(const QRect& rect) override;
  QSize sizeHint() const override { return minimumSize(); }
  QSize minimumSize() const override;

 private:
  int arrange(const QRect& rect, bool move) const;  ///< the height that is used
  QList<QLayoutItem*> items_;
  int gap_;
};

}  // namespace glint::gui
