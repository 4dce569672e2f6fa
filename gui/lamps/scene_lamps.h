// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QObject>
#include <memory>

#include "core/report/measured_lamps.h"
#include "gui/base/actions.h"
#include "gui/base/job_queue.h"
#include "gui/document/document.h"

class QMenu;
class QWidget;

namespace glint::gui {

class LampsPanel;

using LampsPtr = std::shared_ptr<const LampsReport>;

/// The lamps of the open scene: measured in the background when a person asks, shown in a dock and in the 3D views, saved as
/// `glint lights` writes them. Measured with the settings, frames and what-if on screen; once these change, they are out of
/// date. A session keeps that they were measured (option "lamps/measured"), as it keeps no fit either: once its results are
/// there, they are measured again.
class SceneLamps : public QObject {
  Q_OBJECT
 public:
  SceneLamps(const Engine& engine, Document& document, QWidget* window);
  LampsPanel* panel() const { return panel_; }
  void addActions(Actions& actions, QMenu* menu);
  bool busy() const { return jobs_.busy(); }
  /// The newest; null before the first.
  const LampsPtr& lamps() const { return lamps_; }

 public slots:
  void measure();
  void cancel() { jobs_.stop(); }
  /// Asks for a file and writes them there.
  void save();

 signals:
  void changed(const std::shared_ptr<const std::vector<glint::LampAnswer>>& lamps);  ///< for the 3D views; null = none
  void shown();                                                                      ///< a person asked for them
  void problem(const QString& oneLine);
  void message(const QString& oneLine);

 private:
  void forget();
  void remember();
  void measureAgain();
  void take(const LampsPtr& lamps, const InspectionRequest& measuredFor);
  void markStale();
  void selectFromDocument();
  void selectFromTable(int lamp);
  const Engine& engine_;
  Document& document_;
  QWidget* window_;
  LampsPanel* panel_;
  LampsPtr lamps_;
  std::shared_ptr<const Scene> scene_;  ///< whose they are
  InspectionRequest measuredFor_;
  bool selecting_ = false;
  bool again_ = false;  ///< the session was saved with lamps, and waits for its results
  JobQueue jobs_;
};

}  // namespace glint::gui
