// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QAbstractTableModel>
#include <QString>
#include <memory>
#include <vector>

#include "core/inspect/inspection.h"
#include "gui/document/document.h"

namespace glint::gui {

/// The error table's rows: one per frame, model and matched, missed or spurious highlight, and one per prediction that failed,
/// each with its reason.
class ErrorModel : public QAbstractTableModel {
  Q_OBJECT
 public:
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
    Time,
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
  int frameOf(int row) const { return rows_[std::size_t(row)].frame; }
  const std::string& modelOf(int row) const { return rows_[std::size_t(row)].model; }
  int highlightOf(int row) const { return rows_[std::size_t(row)].highlight; }
  /// What a row selects: its highlight; a spurious one with its light.
  draw::Selection selectionOf(int row) const;

 private:
  struct Row {
    int frame = -1, highlight = -1, predicted = -1;  ///< predicted: of a spurious one
    std::string lightId;
    FrameRole role = FrameRole::HeldOut;
    std::string model;
    QString frameId, light, status, reason;
    bool problem = false;
    double values[ColumnCount];  ///< NaN where a column has no number
  };
  void rebuild();
  void addComparison(const Inspection& inspection, const std::string& model, const FrameComparison& comparison);

  Document& document_;
  std::vector<Row> rows_;
};

}  // namespace glint::gui
