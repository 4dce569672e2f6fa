// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QDialog>

class QLabel;
class QLineEdit;

namespace glint::gui {

/// Asks for a folder that does not exist yet: its whole path in a line, and a button that chooses where it is to lie.
class FolderRow : public QWidget {
  Q_OBJECT
 public:
  /// @param suggested  a path; where it is taken, the next number is appended.
  explicit FolderRow(const QString& suggested, QWidget* parent = nullptr);
  QString folder() const;
  /// Why nothing can be written there; empty if it can.
  QString problem() const;

 signals:
  void changed();

 private:
  void chooseParent();
  void showNote();
  QLineEdit* line_;
  QLabel* note_;
};

/// A dialog of one such row.
class FolderDialog : public QDialog {
  Q_OBJECT
 public:
  /// @param what  one sentence: what the folder will hold. @param verb  of the button that goes on.
  FolderDialog(const QString& title, const QString& what, const QString& suggested, const QString& verb, QWidget* parent);
  QString folder() const { return row_->folder(); }

 private:
  FolderRow* row_;
};

}  // namespace glint::gui
