// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QList>
#include <QSet>
#include <QStringList>
#include <QWidget>
#include <array>
#include <map>
#include <memory>
#include <optional>

#include "core/advise/explain.h"
#include "gui/base/actions.h"
#include "gui/base/latest_job.h"
#include "gui/document/document.h"

class QLabel;
class QListWidget;
class QSplitter;
class QToolButton;
class QUrl;

namespace glint::gui {

class DualityWindow;
class EquationBrowser;
class WalkPlayer;
class WalkView;

/// The guided way from the photograph to the prediction, on whatever is open: one step at a time, with its equation, its numbers
/// of the selected highlight, and what breaks here. A step shows its layers alone; leaving gives back those that were shown
/// before. In a lesson (option "explain/lesson") it begins with what there is to see, goes through the lesson's own steps with
/// its remarks, and ends with questions, their answers and the next lesson.
class ExplainPanel : public QWidget {
  Q_OBJECT
 public:
  explicit ExplainPanel(Document& document, QWidget* parent = nullptr);
  void addActions(Actions& actions, QMenu* menu);
  int step() const;  ///< -1 = not explaining
  const Explanation* explanation() const { return explanation_.get(); }
  bool busy() const;
  WalkPlayer& walk() { return *walk_; }
  EquationBrowser& text() { return *text_; }

 public slots:
  void start();
  void leave();
  void next();
  void back();
  void goTo(int step);

 signals:
  void started();  ///< someone asked for it, at any step
  void left();     ///< also by undo, and by another scene
  /// A step asks for its part of the scene: see ScenePanel::look.
  void look(const QString& at, int highlight, const QString& model);
  void lessonRequested(const QString& session);
  /// A link leads to a page of the documentation. @param page  "glossary" or "method". @param place  a word or section there.
  void readRequested(const QString& page, const QString& place);
  void dualityOpened(glint::gui::DualityWindow* window);  ///< every time
  void problem(const QString& oneLine);
  void panelRequested(const QString& dock);  ///< a text leads to a panel: to be brought to the front

 protected:
  void changeEvent(QEvent* e) override;
  void resizeEvent(QResizeEvent* e) override;

 private:
  void compute();
  void refresh();
  void lookAtStep();
  void showText();
  void showWalk();
  void fitSteps();
  void layTrack();
  int neighbour(int by) const;
  QString subject() const;
  void openLesson(const QString& id);
  void openDuality();
  void follow(const QUrl& link);

  Document& document_;
  LatestJob job_;
  std::shared_ptr<const Explanation> explanation_;
  std::map<std::string, bool> layersBefore_;  ///< what was shown before the first step
  std::string soloBefore_;                    ///< and whether of the selected frame alone
  std::string linesBefore_;                   ///< and which epipolar lines
  bool explaining_ = false;                   ///< a step was shown last
  bool lookPending_ = false;                  ///< the step on screen has nothing computed to show yet
  InspectionRequest lessonRequest_;           ///< what was asked for when the scene was opened: lessons speak of that
  QString lookedAt_;                          ///< what the views were sent to last; "" = wherever a session left them
  Actions* actions_ = nullptr;
  WalkPlayer* walk_;
  WalkView* walkView_;
  QSplitter* split_;
  QListWidget* steps_;
  std::array<int, 3> fitted_{};  ///< panel, list, walk: heights that the parts were last given for
  EquationBrowser* text_;
  QString shown_, shownPlace_;  ///< by it, and of which lesson and step
  QList<int> track_;            ///< steps to go through, as indices of explainTexts().steps; never empty
  QStringList rows_;            ///< of the list
  QSet<int> unfolded_;          ///< questions of the lesson whose answers are shown
  QLabel* place_;
  DualityWindow* duality_ = nullptr;  ///< made when it is first asked for
  QToolButton *back_, *next_, *leave_;
};

}  // namespace glint::gui
