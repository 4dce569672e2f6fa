// SPDX-License-Identifier: BSD-3-Clause
#include "gui/base/rows_model.h"

#include <utility>

#include "gui/base/tips.h"

namespace glint::gui {

void RowsModel::setRows(std::vector<Row> rows) {
  beginResetModel();
  rows_ = std::move(rows);
  endResetModel();
}

QVariant RowsModel::data(const QModelIndex& index, int role) const {
  const Row& row = rows_[std::size_t(index.row())];
  if (role == kTagRole) return row.tag;
  const Cell& cell = row.cells[std::size_t(index.column())];
  switch (role) {
    case Qt::DisplayRole: return cell.text;
    case kSortRole: return cell.sort.isValid() ? cell.sort : QVariant(cell.text);
    case Qt::ForegroundRole: return cell.colour.isValid() ? QVariant(cell.colour) : QVariant();
    case Qt::ToolTipRole: return plainTip(cell.tip.isEmpty() ? cell.text : cell.tip);
    case Qt::TextAlignmentRole: return int(Qt::AlignVCenter) | int(cell.number ? Qt::AlignRight : Qt::AlignLeft);
    default: return {};
  }
}

QVariant RowsModel::headerData(int section, Qt::Orientation orientation, int role) const {
  if (orientation != Qt::Horizontal || role != Qt::DisplayRole) return {};
  return head_[section];
}

}  // namespace glint::gui
