// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QStringList>
#include <QWidget>

class QVBoxLayout;

namespace glint::gui {

/// What an empty window shows: what to do first, and the recent files.
class StartPage : public QWidget {
  Q_OBJECT
 public:
  explicit StartPage(QWidget* parent = nullptr);
  void setRecent(const QStringList& files);
  /// One more session to learn from.
  void addLesson(const QString& title, const QString& file);

 signals:
  void openFile();
  void openFolder();
  void openRecent(const QString& path);

 private:
  QVBoxLayout *lessons_, *recent_;
};

}  // namespace glint::gui
