// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QWidget>

#include "gui/document.h"

class QComboBox;
class QLabel;
class QListWidget;

namespace glint::gui {

/// What is computed: models (checkable, in their colours), training frames, and which pictures.
class SetupPanel : public QWidget {
  Q_OBJECT
 public:
  explicit SetupPanel(Document& document, QWidget* parent = nullptr);

 signals:
  void problem(const QString& oneLine);

 private:
  void refresh();
  void setTrain();

  Document& document_;
  QListWidget* models_;
  QComboBox* train_;
  QComboBox* source_;
  QLabel* counts_;
};

}  // namespace glint::gui
