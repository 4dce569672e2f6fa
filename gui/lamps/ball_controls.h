// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QWidget>
#include <array>

#include "core/report/measured_lamps.h"
#include "gui/lamps/ball_outlines.h"

class QComboBox;
class QFormLayout;
class QLabel;
class QLineEdit;
class QListWidget;
class QPushButton;

namespace glint::gui {

class NumberBox;

/// Beside the photograph: the balls as a list and in numbers, and what is known of camera and balls.
class BallControls : public QWidget {
  Q_OBJECT
 public:
  explicit BallControls(BallOutlines& outlines, QWidget* parent = nullptr);
  /// @param folders  with photographs, below the chosen one; "" = itself. Asks where they were cut out where there are several.
  void setFolders(const QStringList& folders);
  /// New balls are added in the middle, with a quarter of this size.
  void setPhotographSize(QSize size) { size_ = size; }
  /// Camera, radius and outlines of this question; its balls are the outlines'.
  void show(const BallQuestion& question);
  /// Camera, radius and outlines as typed. If one is wrong: why, which its field shows, too; else "".
  QString fill(BallQuestion& question);

 signals:
  void questionChanged();  ///< other than the outlines
  void copyRequested();

 private:
  QString refused(QLineEdit* field, const QString& why);
  void buildBalls(QFormLayout* form);
  void buildCutOuts(QFormLayout* form);
  void buildCamera(QFormLayout* form);
  void refresh();
  void takeNumbers();
  BallOutlines& outlines_;
  QSize size_{640, 480};
  QListWidget* list_;
  QPushButton *middle_, *rim_, *remove_, *undo_, *redo_;
  QLabel* hint_;
  std::array<NumberBox*, 3> numbers_{};
  std::array<NumberBox*, 2> corner_{};
  QComboBox *folder_, *outlineChoice_;
  QWidget* cutOuts_ = nullptr;
  QLineEdit *camera_, *radius_;
  bool refreshing_ = false;
};

}  // namespace glint::gui
