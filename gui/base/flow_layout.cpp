// SPDX-License-Identifier: BSD-3-Clause
#include "gui/base/flow_layout.h"

#include <QWidget>
#include <algorithm>

namespace glint::gui {

FlowLayout::~FlowLayout() {
  while (QLayoutItem* item = takeAt(0)) delete item;
}

void FlowLayout::setGeometry(const QRect& rect) {
  QLayout::setGeometry(rect);
  arrange(rect, true);
}

QSize FlowLayout::minimumSize() const {
  QSize size;
  for (const QLayoutItem* item : items_)
    if (!item->isEmpty()) size = size.expandedTo(item->minimumSize());
  const QMargins m = contentsMargins();
  return size + QSize(m.left() + m.right(), m.top() + m.bottom());
}

int FlowLayout::arrange(const QRect& rect, bool move) const {
  const QMargins m = contentsMargins();
  const QRect room = rect.marginsRemoved(m);
  // A line ends where the width does; its widgets are centred on it.
  QList<QLayoutItem*> line;
  int x = room.left(), y = room.top(), tall = 0;
  const auto place = [&] {
    int at = room.left();
    for (QLayoutItem* item : std::as_const(line)) {
      const QSize size = item->sizeHint();
      if (move) item->setGeometry({QPoint(at, y + (tall - size.height()) / 2), size});
      at += size.width() + gap_;
    }
    line.clear();
  };
  for (QLayoutItem* item : items_) {
    if (item->isEmpty()) continue;
    const QSize size = item->sizeHint();
    if (!line.isEmpty() && x + size.width() > room.left() + room.width()) {
      place();
      x = room.left();
      y += tall + gap_;
      tall = 0;
    }
    line.append(item);
    x += size.width() + gap_;
    tall = std::max(tall, size.height());
  }
  place();
  return y + tall + m.bottom() - rect.top();
}

}  // namespace glint::gui
