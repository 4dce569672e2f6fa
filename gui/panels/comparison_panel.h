// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QWidget>
#include <memory>

#include "core/report/compare_runs.h"
#include "gui/base/actions.h"
#include "gui/document/document.h"

class QCheckBox;
class QLabel;
class QTableView;

namespace glint::gui {

class LongJob;
class RowsModel;

/// Names for two files that tell them apart: the shortest ends of their paths that differ, whole parts ("a/x.glint",
/// "b/x.glint"), the same number of parts for both. Equal paths give their file name twice.
std::pair<QString, QString> shortestNames(const QString& fileA, const QString& fileB);

/// What is on screen (A) beside another session (B): what changed in inputs, parameters and results, and the error of every frame
/// with both. Shows only differences unless asked for all; a click on a frame selects it.
class ComparisonPanel : public QWidget {
  Q_OBJECT
 public:
  ComparisonPanel(const Engine& engine, Document& document, LongJob& job, QWidget* parent = nullptr);
  void addActions(Actions& actions, QMenu* menu);
  const RunComparison* comparison() const { return comparison_.get(); }

 public slots:
  /// Asks for a session.
  void choose();
  /// Opens and computes it off the interface thread, then shows the comparison.
  void compareWith(const QString& file);

 signals:
  void shown();
  void problem(const QString& oneLine);

 private:
  void show(std::shared_ptr<const RunComparison> comparison, const QString& fileA, const QString& fileB);
  void fill();
  void showState();
  void selectRow(const QModelIndex& row);

  const Engine& engine_;
  Document& document_;
  LongJob& job_;
  std::shared_ptr<const RunComparison> comparison_;
  std::shared_ptr<const Inspection> of_;  ///< A
  QString names_, paths_;                 ///< of A and B: short, and in full
  QLabel* title_;
  QCheckBox* onlyDifferences_;
  RowsModel *values_, *errors_, *models_;
  QTableView *valueTable_, *errorTable_, *modelTable_;
};

}  // namespace glint::gui
