// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QImage>
#include <QObject>
#include <functional>

#include "gui/base/actions.h"
#include "gui/document/document.h"
#include "gui/export/figure_dialog.h"

class QWidget;

namespace glint::gui {

class FramePanel;
class LongJob;
class ScenePanel;

/// The 3D view and the frame view as they are on screen, at any size: PNG with the session inside, the frame view also as SVG or
/// PDF with its overlays as strokes.
class FigureActions : public QObject {
  Q_OBJECT
 public:
  FigureActions(const Engine& engine, Document& document, ScenePanel& scene, FramePanel& frame, LongJob& job, QWidget* window);
  void addActions(Actions& actions, QMenu* menu);
  void setSnapshot(std::function<Opened()> snapshot) { snapshot_ = std::move(snapshot); }

  /// Draw at once and write off the interface thread; written() or problem() tells how it ended.
  void writeScene(const FigureLook& look, const QString& file);
  /// @param file  .png, .svg or .pdf. Two frames side by side stay that.
  void writeFrame(const FigureLook& look, const QString& file);

 signals:
  void problem(const QString& oneLine);
  void written(const QString& file);

 private:
  /// All 3D views as they lie beside each other, or the one.
  QImage sceneFigure(const FigureLook& look) const;
  /// The frames with the caption below.
  void paintFigure(QPainter& painter, const FigureLook& look) const;
  void paintFrames(QPainter& painter, const FigureLook& look) const;
  /// The key of the epipolar lines of two frames, with their misses, above the pictures. Its height, px; 0 without lines.
  double paintKey(QPainter& painter, const FigureLook& look) const;
  void write(const QString& file, std::function<void()> work);

  const Engine& engine_;
  Document& document_;
  ScenePanel& scene_;
  FramePanel& frame_;
  LongJob& job_;
  QWidget* window_;
  std::function<Opened()> snapshot_;
};

/// A name for what is exported, after the session and what is shown: "vase-frame.png", where the last export of this input went,
/// else beside the session.
QString suggestedFile(const Document& document, const QString& what, const QString& ending);
/// Why nothing is written of what is on screen while Document::shownStale().
QString notUpToDate();
/// Remembers that `file` was exported.
void rememberExport(const Document& document, const QString& file);
/// Asks for a file to write; the chosen filter's ending is added where the name has none. Files of the input are refused, and
/// asked again. "" = given up.
QString askForFile(QWidget* window, const Document& document, const QString& title, const QString& suggestion,
                   const QString& filters);

}  // namespace glint::gui
