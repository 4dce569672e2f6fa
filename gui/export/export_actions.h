// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QObject>
#include <functional>

#include "gui/base/actions.h"
#include "gui/base/latest_job.h"
#include "gui/document/document.h"
#include "gui/export/long_job.h"

class QWidget;

namespace glint::gui {

class FigureActions;
class FramePanel;
class MovieActions;
class ReproActions;
class RetextureBar;
class ScenePanel;

/// Exports: figures with the session inside, reports, labels, the command line of what is on screen, a diagnostic
/// report. The `write…` functions do the work and throw InputError; the actions ask for a file and run them off the interface
/// thread.
class ExportActions : public QObject {
  Q_OBJECT
 public:
  ExportActions(const Engine& engine, Document& document, QWidget* window);
  /// The views whose pictures are exported. Call before addActions.
  void setViews(ScenePanel& scene, FramePanel& frame);
  void addActions(Actions& actions, QMenu* menu);
  /// The state to put into figures.
  void setSnapshot(std::function<Opened()> snapshot);
  /// Lines of the log, for the diagnostic report.
  void setLog(std::function<QString()> log) { log_ = std::move(log); }
  bool busy() const { return job_.busy() || long_.busy(); }
  FigureActions* figures() { return figures_; }
  MovieActions* movies() { return movies_; }
  ReproActions* repro() { return repro_; }
  /// Masks and COCO labels of all models as a folder, off the interface thread.
  void writeLabels(const QString& folder);
  LongJob* longJob() { return &long_; }

  /// The command line that computes what is on screen; on failure the reason.
  Outcome<std::string> command() const;
  /// The command line that draws the window again, from the session that holds what it shows. The 3D cameras are those of when it
  /// was saved. On failure the reason.
  Outcome<std::string> windowCommand() const;
  /// Versions, settings, shape of the scene and the log, without any folder of this machine.
  QString diagnosticReport() const;

 public slots:
  void copyCommand();
  void copyWindowCommand();
  /// Asks for a file and writes what the frame view shows retextured.
  void saveRetextured();

 signals:
  void problem(const QString& oneLine);
  void message(const QString& oneLine);
  /// A session that the user may want to look at next.
  void sessionWritten(const QString& oneLine, const QString& session);

 private:
  std::string sessionPath() const;
  bool ready();  ///< there are results to write, and they are what is asked for; else says why not
  void copy(const Outcome<std::string>& command);
  using Write = std::function<void(const QString& file)>;
  void ask(const QString& title, const QString& name, const QString& filter, const std::function<Write()>& prepare);

  const Engine& engine_;
  Document& document_;
  QWidget* window_;
  std::function<Opened()> snapshot_;
  std::function<QString()> log_;
  LatestJob job_;
  LongJob long_;
  FigureActions* figures_ = nullptr;
  MovieActions* movies_ = nullptr;
  ReproActions* repro_;
  RetextureBar* retexture_ = nullptr;
};

}  // namespace glint::gui
