// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QAbstractTableModel>
#include <QString>
#include <map>
#include <memory>
#include <vector>

#include "core/advise/highlight_rows.h"
#include "gui/document/document.h"

namespace glint::gui {

/// The error table's rows: one per frame, model and matched, missed or spurious highlight, and one per prediction that failed,
/// each with its reason. While results are pinned, two more columns have the pinned error and the difference.
class ErrorModel : public QAbstractTableModel {
  Q_OBJECT
 public:
  /// From ErrorPct on the numbers of highlightColumns(), in their order without the frame's position.
  enum Column {
    Frame,
    Role,
    Model,
    Light,
    Status,
    ErrorPct,
    ErrorPx,
    EllipsePct,
    Hausdorff,
    Iou,
    Coverage,
    CentreOffset,
    PeakOffset,
    LastNumber = ErrorPct + int(kRowValues) - 2,
    Pinned,
    Difference,
    ReasonText,
    ColumnCount
  };
  static constexpr int kSortRole = Qt::UserRole;  ///< numbers as numbers, for sorting
  static constexpr int kProblemRole = Qt::UserRole + 1;
  static constexpr int kFrameRoleRole = Qt::UserRole + 2;

  explicit ErrorModel(Document& document, QObject* parent = nullptr);
  int rowCount(const QModelIndex& parent = {}) const override;
  int columnCount(const QModelIndex& parent = {}) const override;
  QVariant data(const QModelIndex& index, int role) const override;
  QVariant headerData(int section, Qt::Orientation orientation, int role) const override;
  int frameOf(int row) const { return at(row).frame; }
  const std::string& modelOf(int row) const { return at(row).model; }
  int highlightOf(int row) const { return at(row).observed; }
  const HighlightRow& at(int row) const { return (*rows_)[std::size_t(row)]; }
  /// What a row selects: its highlight; a missed or spurious one with its light.
  draw::Selection selectionOf(int row) const;
  /// Every text of the row, in lower case, for a search.
  const QString& textOf(int row) const;
  /// What a column is called in the program's settings: "error-pct".
  static QString idOf(int column);
  /// The models among the rows, from simple to rich.
  QStringList models() const;
  /// All rows belong to an earlier request: faded.
  void setEarlier(bool earlier);

 private:
  void rebuild();
  /// The pinned row of the same highlight; null without one, or without pinned results.
  const HighlightRow* pinnedOf(int row) const;
  QString cell(int row, int column) const;
  QVariant sorted(int row, int column) const;
  QString differenceText(int row) const;
  QVariant colour(int row, int column) const;
  QVariant tip(int row, int column) const;

  Document& document_;
  RowsPtr rows_, pinnedRows_;
  std::vector<int> counterparts_;  ///< of each row among the pinned ones; empty = nothing to compare with
  mutable std::vector<QString> texts_;
  bool earlier_ = false;
  std::map<std::string, QString> poor_;  ///< models whose fit is poor, and why
};

}  // namespace glint::gui
