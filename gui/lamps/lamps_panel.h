// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QWidget>

#include "core/report/lamps_report.h"

class QLabel;
class QProgressBar;
class QPushButton;

namespace glint::gui {

class LampTable;
class StaleBadge;

/// The table of measured lamps with what belongs to it: buttons, progress, warnings. Knows no document.
class LampsPanel : public QWidget {
  Q_OBJECT
 public:
  explicit LampsPanel(QWidget* parent = nullptr);
  LampTable* table() const { return table_; }
  /// @param report  null = no lamps, because `why`
  void show(const LampsReport* report, const QString& why);
  void setStale(bool stale);
  /// @param possible  there is something to measure
  void setPossible(bool possible);
  void setBusy(bool busy);
  void setProgress(const QString& stage, int done, int total);

 signals:
  void measureRequested();
  void stopRequested();
  void saveRequested();

 private:
  void refresh();
  LampTable* table_;
  QLabel *summary_, *warnings_;
  QPushButton *measure_, *stop_, *save_;
  QProgressBar* bar_;
  StaleBadge* stale_;
  bool busy_ = false, possible_ = false, known_ = false;
};

}  // namespace glint::gui
