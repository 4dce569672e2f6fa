// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QObject>

#include "gui/lamps/scene_lamps.h"

namespace glint::gui {

class BallWindow;
class ScenePanel;

/// Everything about measured lamps that the main window holds: those of the open scene, and the window of photographs of balls.
class LampsInWindow : public QObject {
  Q_OBJECT
 public:
  LampsInWindow(const Engine& engine, Document& document, ScenePanel& scene, QWidget* window);
  LampsPanel* panel() const { return lamps_->panel(); }
  SceneLamps* ofScene() const { return lamps_; }
  /// @param plots,file  menus; "edit.stop" is among the actions already
  void addActions(Actions& actions, QMenu* plots, QMenu* file);
  bool busy() const;
  /// Photographs of mirror balls in a window of their own; null before the first.
  BallWindow* balls() const { return balls_; }
  /// The same while it is on screen.
  QWidget* shownBalls() const;

 public slots:
  /// Asks for a folder of photographs.
  void openBalls();
  void openBalls(const QString& folder);
  /// The same with outlines, and measures. InputError. @param photograph  that is shown first, "" = any
  void openBalls(const BallQuestion& question, const QString& photograph);

 signals:
  void shown();
  void problem(const QString& oneLine);
  void message(const QString& oneLine);

 private:
  BallWindow* ballWindow();
  const Engine& engine_;
  QWidget* window_;
  SceneLamps* lamps_;
  BallWindow* balls_ = nullptr;
};

}  // namespace glint::gui
