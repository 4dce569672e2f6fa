// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QAbstractButton>
#include <QPixmap>
#include <QStringList>
#include <QWidget>

class QVBoxLayout;

namespace glint::gui {

class FlowLayout;

/// A picture with a title below it, to be opened by a click, Enter or the space bar.
class Tile : public QAbstractButton {
  Q_OBJECT
 public:
  /// @param picture  of resources/tiles, "" = none.
  Tile(const QString& title, const QString& picture, QWidget* parent = nullptr);
  QSize sizeHint() const override;
  bool hasPicture() const { return !picture_.isNull(); }

 protected:
  void paintEvent(QPaintEvent*) override;
  void keyPressEvent(QKeyEvent* e) override;

 private:
  QPixmap picture_;
};

/// The content of an empty window: what this is, what to do first, lessons and sessions, and the recent files. Tab and the
/// arrow keys go through all of it.
class StartPage : public QWidget {
  Q_OBJECT
 public:
  explicit StartPage(QWidget* parent = nullptr);
  void setRecent(const QStringList& files);
  /// One more session to learn from.
  void addLesson(const QString& title, const QString& file, const QString& picture);
  /// One more session that came with the program.
  void addExample(const QString& title, const QString& file, const QString& picture);

 signals:
  void openFile();
  void openFolder();
  void openRecent(const QString& path);

 protected:
  bool eventFilter(QObject* watched, QEvent* event) override;

 private:
  void addTile(QVBoxLayout* column, FlowLayout*& row, const QString& heading, const QString& title, const QString& file,
               const QString& picture);

  QVBoxLayout *lessons_, *examples_, *recent_;
  FlowLayout *lessonTiles_ = nullptr, *exampleTiles_ = nullptr;
};

/// Adds a tile for each lesson and each session that came with the program, where they are found.
void fillStartPage(StartPage& page);

}  // namespace glint::gui
