// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QSortFilterProxyModel>
#include <QString>
#include <optional>
#include <set>

#include "core/advise/highlight_rows.h"

namespace glint::gui {

class ErrorModel;

/// Which rows of the error table are shown: those that pass every choice.
class RowFilter : public QSortFilterProxyModel {
  Q_OBJECT
 public:
  enum class Frames { All, HeldOut, Training, Problems, Brushed };

  explicit RowFilter(ErrorModel& rows, QObject* parent = nullptr);
  void setFrames(Frames frames);
  void setModel(const QString& model);                     ///< "" = all
  void setStatus(const std::optional<RowStatus>& status);  ///< none = all
  /// Rows with all of these words, in any cell.
  void setSearch(const QString& words);
  void setBrushed(const std::set<RowKey>& brushed);

 protected:
  bool filterAcceptsRow(int row, const QModelIndex& parent) const override;
  bool lessThan(const QModelIndex& left, const QModelIndex& right) const override;

 private:
  const ErrorModel& rows_;
  Frames frames_ = Frames::All;
  std::string model_;
  std::optional<RowStatus> status_;
  QStringList words_;
  std::set<RowKey> brushed_;
};

}  // namespace glint::gui
