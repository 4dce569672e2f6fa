// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QAbstractTableModel>
#include <QColor>
#include <QStringList>
#include <QVariant>
#include <vector>

namespace glint::gui {

/// A plain table for reading: rows of texts, each with its sort key.
class RowsModel : public QAbstractTableModel {
  Q_OBJECT
 public:
  struct Cell {
    QString text;
    QVariant sort = {};  ///< invalid = by the text
    QColor colour = {};  ///< invalid = the usual one
    QString tip = {};
    bool number = false;  ///< aligned right
  };
  struct Row {
    std::vector<Cell> cells;
    int tag = -1;  ///< whatever the owner knows it by
  };
  static constexpr int kSortRole = Qt::UserRole, kTagRole = Qt::UserRole + 1;

  explicit RowsModel(QStringList head, QObject* parent = nullptr) : QAbstractTableModel(parent), head_(std::move(head)) {}
  void setRows(std::vector<Row> rows);
  int rowCount(const QModelIndex& parent = {}) const override { return parent.isValid() ? 0 : int(rows_.size()); }
  int columnCount(const QModelIndex& parent = {}) const override { return parent.isValid() ? 0 : head_.size(); }
  QVariant data(const QModelIndex& index, int role) const override;
  QVariant headerData(int section, Qt::Orientation orientation, int role) const override;

 private:
  QStringList head_;
  std::vector<Row> rows_;
};

}  // namespace glint::gui
