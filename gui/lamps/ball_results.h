// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QTabWidget>

#include "core/report/lamps_report.h"

class QTableView;

namespace glint::gui {

class LampsPanel;
class PlotCanvas;
class RowsModel;

/// Results from photographs of balls: the lamps, each ball's residuals, and each photograph's contribution.
class BallResults : public QTabWidget {
  Q_OBJECT
 public:
  explicit BallResults(QWidget* parent = nullptr);
  LampsPanel* lamps() const { return lamps_; }
  QTableView* balls() const { return balls_; }
  PlotCanvas* residuals() const { return residuals_; }
  PlotCanvas* shares() const { return shares_; }
  /// @param report  null = none, because `why`
  void show(const LampsReport* report, const QString& why);
  /// Selects this lamp, which is that of a photograph; -1 = none.
  void select(int lamp);

 signals:
  void lampSelected(int lamp);

 private:
  LampsPanel* lamps_;
  QTableView* balls_;
  RowsModel* ballRows_;
  PlotCanvas *residuals_, *shares_;
};

}  // namespace glint::gui
