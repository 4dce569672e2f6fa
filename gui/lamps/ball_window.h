// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QWidget>
#include <memory>
#include <set>

#include "gui/base/job_queue.h"
#include "gui/document/engine.h"
#include "gui/frame/photo_loader.h"
#include "gui/lamps/ball_outlines.h"

class QLabel;
class QListWidget;

namespace glint::gui {

class BallControls;
class BallResults;
class FrameCanvas;

/// Lamps from photographs of mirror balls: draw each ball's outline, measure, look at the results. One lamp in each
/// photograph. It asks the same as `glint lights FOLDER --ball …`, and knows no scene.
class BallWindow : public QWidget {
  Q_OBJECT
 public:
  explicit BallWindow(const Engine& engine, QWidget* parent = nullptr);
  ~BallWindow() override;
  /// Photographs of a folder, or of its folders where it has none itself. False, with a problem, without any photograph.
  bool open(const QString& folder);
  /// Opens the folder and shows what is asked, for measure(). False, with a problem, where it has no photographs; InputError.
  bool ask(const BallQuestion& question);
  /// Shows the photograph of this name, with or without its ending, if it exists.
  void showPhotograph(const QString& name);
  /// Nothing runs, and the photograph is there.
  bool idle() const { return !jobs_.busy() && !loader_->busy(); }
  BallOutlines& outlines() { return *outlines_; }
  FrameCanvas* canvas() const { return canvas_; }
  BallResults* results() const { return results_; }
  /// The newest; null before the first.
  std::shared_ptr<const LampsReport> report() const { return report_; }
  /// What would be asked now. False, and a message says where, if something typed is wrong.
  bool question(BallQuestion& question);

 public slots:
  void measure();
  void cancel() { jobs_.stop(); }
  void save();

 signals:
  void problem(const QString& oneLine);
  void message(const QString& oneLine);

 protected:
  void keyPressEvent(QKeyEvent* e) override;

 private:
  QWidget* photographColumn();
  void connectParts();
  void listPhotographs();
  void showCurrent();
  void showOverlay();
  void takeReport(const Outcome<LampsReport>& report);
  void markStale();
  void selectLamp(int lamp);
  const LampAnswer* lampOf(const QString& photograph) const;
  void tell(const QString& line, bool wrong);

  const Engine& engine_;
  QString folder_;
  BallOutlines* outlines_;
  QListWidget* photographs_;
  FrameCanvas* canvas_;
  BallControls* controls_;
  BallResults* results_;
  QLabel* status_;
  PhotoLoader* loader_;
  std::shared_ptr<const Scene> pictures_;  ///< of the shown folder: a frame for each photograph
  std::shared_ptr<const LampsReport> report_;
  double residualScale_ = 1;
  std::set<QString> left_;  ///< names of photographs that are left out
  bool listing_ = false, changedSince_ = false;
  JobQueue jobs_;
};

}  // namespace glint::gui
