// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QWidget>

class QAction;
class QPlainTextEdit;

namespace glint::gui {

/// What happened, line by line with the time of day; the last 2,000 lines.
class LogPanel : public QWidget {
  Q_OBJECT
 public:
  explicit LogPanel(QWidget* parent = nullptr);
  void add(const QString& line);
  QString text() const;
  /// A button above the lines.
  void setReport(QAction* action);

 private:
  QPlainTextEdit* lines_;
};

}  // namespace glint::gui
