// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QTreeWidget>
#include <memory>
#include <optional>

#include "gui/document/document.h"

namespace glint::gui {

/// Numbers of what is selected or was picked, one "name, value" pair a line; Ctrl+C or the context menu copies.
class NumbersPanel : public QTreeWidget {
  Q_OBJECT
 public:
  explicit NumbersPanel(Document& document, QWidget* parent = nullptr);
  /// Shows the lines "name = value" of a pick above those of the selection, until the selection changes. When results change, a
  /// camera's lines follow; of what else was picked the title says that they are of earlier results.
  void showPicked(const viz::Picked& picked);
  QString text() const;
  void copy() const;

 protected:
  void keyPressEvent(QKeyEvent* e) override;

 private:
  void refresh();
  void addPicked();
  QTreeWidgetItem* addGroup(const QString& title, const QString& lines);

  Document& document_;
  std::optional<viz::Picked> picked_;
  std::weak_ptr<const Inspection> pickedIn_;  ///< what its lines are of
};

}  // namespace glint::gui
