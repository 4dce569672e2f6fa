// SPDX-License-Identifier: BSD-3-Clause
#include "gui/lamps/lamps_in_window.h"

#include <QAction>
#include <QFileDialog>
#include <QMenu>

#include "gui/base/text.h"
#include "gui/lamps/ball_window.h"
#include "gui/lamps/lamps_panel.h"
#include "gui/scene/scene_panel.h"
#include "gui/scene/scene_views.h"

namespace glint::gui {

LampsInWindow::LampsInWindow(const Engine& engine, Document& document, ScenePanel& scene, QWidget* window)
    : QObject(window), engine_(engine), window_(window), lamps_(new SceneLamps(engine, document, window)) {
  connect(lamps_, &SceneLamps::shown, this, &LampsInWindow::shown);
  connect(lamps_, &SceneLamps::problem, this, &LampsInWindow::problem);
  connect(lamps_, &SceneLamps::message, this, &LampsInWindow::message);
  connect(lamps_, &SceneLamps::changed, &scene,
          [&scene](const std::shared_ptr<const std::vector<LampAnswer>>& lamps) { scene.views().setLamps(lamps); });
}

void LampsInWindow::addActions(Actions& actions, QMenu* plots, QMenu* file) {
  lamps_->addActions(actions, plots);
  // Before the entry that leaves the program.
  QAction* last = file->actions().isEmpty() ? nullptr : file->actions().back();
  QAction* balls =
      actions.add("lamps.balls", file, tr("Measure lamps from &balls…"), [this] { openBalls(); },
                  {{}, {}, tr("Where lamps are, from photographs of mirror balls by one fixed camera, one lamp in each")});
  if (last) {
    file->insertAction(last, balls);
    file->insertSeparator(last);
  }
  if (QAction* stop = actions.find(QStringLiteral("edit.stop"))) connect(stop, &QAction::triggered, lamps_, &SceneLamps::cancel);
}

bool LampsInWindow::busy() const { return lamps_->busy() || (balls_ && balls_->isVisible() && !balls_->idle()); }

void LampsInWindow::openBalls() {
  const QString folder = QFileDialog::getExistingDirectory(window_, tr("Photographs of mirror balls"));
  if (!folder.isEmpty()) openBalls(folder);
}

BallWindow* LampsInWindow::ballWindow() {
  if (!balls_) {
    balls_ = new BallWindow(engine_, window_);
    connect(balls_, &BallWindow::message, this, &LampsInWindow::message);
    connect(balls_, &BallWindow::problem, this, &LampsInWindow::message);  // that window shows it
  }
  return balls_;
}

void LampsInWindow::openBalls(const QString& folder) {
  if (!ballWindow()->open(folder)) return void(emit problem(tr("%1 has no photographs").arg(shownText(folder))));
  balls_->show();
  balls_->raise();
}

void LampsInWindow::openBalls(const BallQuestion& question, const QString& photograph) {
  if (!ballWindow()->ask(question)) return;
  balls_->show();
  balls_->measure();
  if (!photograph.isEmpty()) balls_->showPhotograph(photograph);
}

QWidget* LampsInWindow::shownBalls() const { return balls_ && balls_->isVisible() ? balls_ : nullptr; }

}  // namespace glint::gui
