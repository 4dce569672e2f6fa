// SPDX-License-Identifier: BSD-3-Clause
#include "gui/panels/row_filter.h"

#include <algorithm>
#include <cmath>

#include "gui/panels/error_model.h"

namespace glint::gui {

RowFilter::RowFilter(ErrorModel& rows, QObject* parent) : QSortFilterProxyModel(parent), rows_(rows) {
  setSourceModel(&rows);
  setSortRole(ErrorModel::kSortRole);
}

void RowFilter::setFrames(Frames frames) {
  frames_ = frames;
  invalidateFilter();
}

void RowFilter::setModel(const QString& model) {
  model_ = model.toStdString();
  invalidateFilter();
}

void RowFilter::setStatus(const std::optional<RowStatus>& status) {
  status_ = status;
  invalidateFilter();
}

void RowFilter::setSearch(const QString& words) {
  const QString plain = words.toLower().simplified();
  words_ = plain.isEmpty() ? QStringList() : plain.split(QLatin1Char(' '));
  invalidateFilter();
}

void RowFilter::setBrushed(const std::set<RowKey>& brushed) {
  brushed_ = brushed;
  invalidateFilter();
}

bool RowFilter::filterAcceptsRow(int row, const QModelIndex&) const {
  const HighlightRow& r = rows_.at(row);
  if (!model_.empty() && r.model != model_) return false;
  if (status_ && r.status != *status_) return false;
  switch (frames_) {
    case Frames::HeldOut:
      if (r.role != RowRole::HeldOut) return false;
      break;
    case Frames::Training:
      if (r.role != RowRole::Training) return false;
      break;
    case Frames::Problems:
      if (r.role == RowRole::Excluded || std::isfinite(r.value(RowValue::ErrorPct))) return false;
      break;
    case Frames::Brushed:
      if (!brushed_.count(keyOf(r))) return false;
      break;
    case Frames::All: break;
  }
  if (words_.isEmpty()) return true;
  const QString& text = rows_.textOf(row);
  return std::all_of(words_.begin(), words_.end(), [&](const QString& word) { return text.contains(word); });
}

/// Rows that are equal in this column stay in the order of the frames, whichever way it is sorted.
bool RowFilter::lessThan(const QModelIndex& left, const QModelIndex& right) const {
  if (QSortFilterProxyModel::lessThan(left, right)) return true;
  if (QSortFilterProxyModel::lessThan(right, left)) return false;
  return sortOrder() == Qt::AscendingOrder ? left.row() < right.row() : left.row() > right.row();
}

}  // namespace glint::gui
