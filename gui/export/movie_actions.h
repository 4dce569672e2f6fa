// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QObject>
#include <functional>
#include <memory>

#include "gui/base/actions.h"
#include "gui/document/document.h"
#include "gui/export/movie_dialog.h"

class QWidget;

namespace glint::gui {

class FramePanel;
class LongJob;
class ScenePanel;

/// Movies of the timeline and of a turntable. Encoding, photographs and the frame view's pictures are made on the job's thread;
/// 3D pictures on the interface thread, one at a time, so that it stays free in between.
class MovieActions : public QObject {
  Q_OBJECT
 public:
  MovieActions(Document& document, ScenePanel& scene, FramePanel& frame, LongJob& job, QWidget* window);
  void addActions(Actions& actions, QMenu* menu);
  /// written() or problem() tells how it ended.
  void write(const MovieLook& look, const QString& file);

 signals:
  void problem(const QString& oneLine);
  void written(const QString& file);

 private:
  void ask(MovieOf of);
  void start(const MovieLook& look, const QString& file, std::function<Image(int)> picture);

  struct Stage;
  std::weak_ptr<Stage> stage_;  ///< of the 3D movie that is being made
  Document& document_;
  ScenePanel& scene_;
  FramePanel& frame_;
  LongJob& job_;
  QWidget* window_;
};

}  // namespace glint::gui
