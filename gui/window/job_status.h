// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QTimer>
#include <QWidget>

#include "gui/document/document.h"
#include "gui/document/runner.h"

class QLabel;
class QProgressBar;
class QToolButton;

namespace glint::gui {

/// Right end of the status line: the running job, its progress, and a button that stops it.
class JobStatus : public QWidget {
  Q_OBJECT
 public:
  JobStatus(Document& document, Runner& runner, QWidget* parent = nullptr);

 protected:
  void changeEvent(QEvent* e) override;

 private:
  void refresh();
  /// Updates the badges of out-of-date panels.
  void markBadges();

  Document& document_;
  Runner& runner_;
  bool updating_ = true;  ///< what the badges say
  QLabel* text_ = nullptr;
  QProgressBar* bar_;
  QToolButton* stop_;
  QTimer soon_;
};

}  // namespace glint::gui
