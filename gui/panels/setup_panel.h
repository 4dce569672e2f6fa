// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QWidget>

#include "gui/document/document.h"

class QComboBox;
class QDoubleSpinBox;
class QLabel;
class QPushButton;
class QListWidget;

namespace glint::gui {

/// Chooses what is computed: models (checkable, in their colours), training frames, and which pictures.
class SetupPanel : public QWidget {
  Q_OBJECT
 public:
  explicit SetupPanel(Document& document, QWidget* parent = nullptr);
  /// Why the automatic choice took its model; "" before the first. @param details  the table of candidates.
  void showChoice(const QString& sentence, const QString& details);

 signals:
  void autoRequested(double goodEnoughPct);  ///< 0 = no tolerance

 private:
  void refresh();
  void setTrain();

  Document& document_;
  QListWidget* models_;
  QComboBox* train_;
  QComboBox* source_;
  QLabel* counts_;
  QLabel* choice_;
};

}  // namespace glint::gui
