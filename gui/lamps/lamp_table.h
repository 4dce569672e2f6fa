// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QTableView>
#include <string>

#include "core/report/lamps_report.h"
#include "gui/base/rows_model.h"

class QSortFilterProxyModel;

namespace glint::gui {

/// One row for each lamp: its place with the uncertainty, the residuals of its highlights, dropped ones, and why more is unknown.
class LampTable : public QTableView {
  Q_OBJECT
 public:
  enum Column { Lamp, Answer, StandsStillIn, Position, Direction, Residual, Freedom, Highlights, Dropped, Why };
  explicit LampTable(QWidget* parent = nullptr);
  /// @param report  null = no rows
  void show(const LampsReport* report);
  /// The lamp is an index into the report's. -1 = none. Emits nothing.
  void setCurrentLamp(int lamp);
  int currentLamp() const;

 signals:
  void lampSelected(int lamp);  ///< by a person

 private:
  RowsModel* model_;
  QSortFilterProxyModel* proxy_;
  bool telling_ = false;
};

}  // namespace glint::gui
