// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QObject>

#include "gui/base/latest_job.h"
#include "gui/document/document.h"
#include "gui/document/engine.h"
#include "gui/panels/report_panel.h"

namespace glint::gui {

class FileActions;
class MessageBar;

/// The convention report of what is open: made in the background once the first results are there, or could not be computed;
/// offers the corrections that it proposes, and writes and opens the corrected scene.
class InputReport : public QObject {
  Q_OBJECT
 public:
  InputReport(const Engine& engine, Document& document, FileActions& files, MessageBar& bar, QWidget* window);
  ReportPanel* panel() const { return panel_; }
  /// Makes the report, once for each scene.
  void start();
  bool busy() const { return job_.awaited(); }
  const ReportPtr& report() const { return report_; }
  /// Asks for a file, writes the corrected scene there and opens it. The input stays as it is.
  void fix(const Correction& correction);

 signals:
  void problem(const QString& oneLine);
  void message(const QString& oneLine);
  void shown();  ///< a person asked for it

 private:
  void forget();
  void take(const ReportPtr& report);

  const Engine& engine_;
  Document& document_;
  FileActions& files_;
  MessageBar& bar_;
  QWidget* window_;
  ReportPanel* panel_;
  ReportPtr report_;
  bool started_ = false;
  QString offered_;  ///< on the message bar
  LatestJob job_;
};

}  // namespace glint::gui
