// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QWidget>

class QLabel;

namespace glint::gui {

/// One line across the window for what went wrong; it stays until it is closed or the next success, and blocks nothing.
class MessageBar : public QWidget {
  Q_OBJECT
 public:
  explicit MessageBar(QWidget* parent = nullptr);
  void showError(const QString& oneLine);
  QString text() const;

 private:
  QLabel* label_;
};

}  // namespace glint::gui
