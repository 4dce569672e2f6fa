// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QDialog>

#include "gui/base/actions.h"

class QLabel;
class QLineEdit;
class QTreeWidget;

namespace glint::gui {

/// Every action with its key, to be changed. A key that another action has is taken from it, and the dialog says so.
class ShortcutDialog : public QDialog {
  Q_OBJECT
 public:
  explicit ShortcutDialog(Actions& actions, QWidget* parent = nullptr);
  /// Gives an action one key (none if empty).
  void setShortcut(QAction* action, const QKeySequence& key);

 private:
  void fill();
  /// Asks before it resets.
  void resetAll();
  void filter();

  Actions& actions_;
  QLineEdit* search_;
  QTreeWidget* list_;
  QLabel* note_;
};

}  // namespace glint::gui
