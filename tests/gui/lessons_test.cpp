// SPDX-License-Identifier: BSD-3-Clause
// Lessons and the walk that plays, on the shipped sessions, with the real engine.
#include "gui/explain/lessons.h"

#include <QAction>
#include <QLabel>
#include <QListWidget>
#include <QSlider>
#include <QTextBrowser>
#include <QTextDocument>
#include <QToolButton>

#include "gui/base/text.h"
#include "gui/explain/explain_panel.h"
#include "gui/explain/explain_texts.h"
#include "gui/explain/walk_player.h"
#include "gui/explain/walk_view.h"
#include "gui/scene/scene_panel.h"
#include "gui/window/main_window.h"
#include "tests/gui/fixture.h"

namespace glint::gui {

class LessonsTest : public QObject {
  Q_OBJECT
 private slots:
  void initTestCase() {
    qputenv("GLINT_LESSONS", GLINT_SOURCE_DIR "/sessions/lessons");
    window_ = std::make_unique<MainWindow>(coreEngine());
    window_->show();
    panel_ = window_->findChild<ExplainPanel*>();
    QVERIFY(panel_);
  }
  void cleanupTestCase() { window_.reset(); }

  void everyLessonHasAnActionAndOpensWithItsOverview() {
    QCOMPARE(lessons().size(), 6);
    for (const Lesson& lesson : lessons()) {
      open(lesson.id);
      const QString shown = text();
      QVERIFY2(shown.contains(lesson.title), qPrintable(shown));
      QVERIFY2(shown.contains("Try"), qPrintable(shown));
      QVERIFY2(shown.contains(plain(lesson.see)), qPrintable(shown));
      for (const QString& question : lesson.questions) QVERIFY2(shown.contains(plain(question)), qPrintable(question));
      QCOMPARE(window_->document().undoStack()->count(), 0);
      QVERIFY(panel_->isVisible());
      // Every link is an action.
      for (const QString& part : panel_->findChild<QTextBrowser*>("explain.text")->toHtml().split("href=\"action:").mid(1))
        QVERIFY2(window_->actions().find(part.section('"', 0, 0)), qPrintable(part.section('"', 0, 0)));
      // The first step that it is about, with its remark; those are bold in the list.
      QTest::mouseClick(panel_->findChild<QToolButton*>("explain.next"), Qt::LeftButton);
      const ExplainText& step = explainTexts().steps[panel_->step()];
      QVERIFY2(lesson.steps.contains(step.id), qPrintable(step.id));
      QTRY_VERIFY(!panel_->busy() && panel_->explanation());
      QVERIFY2(text().contains("In this lesson"), qPrintable(text()));
      QVERIFY2(text().contains(plain(lesson.remarks.value(step.id))), qPrintable(text()));
      auto* list = panel_->findChild<QListWidget*>("explain.steps");
      for (int i = 0; i < list->count(); ++i)
        QCOMPARE(list->item(i)->font().bold(), lesson.steps.contains(explainTexts().steps[i].id));
    }
  }

  void aLinkInTheOverviewGoesToItsStep() {
    open("sphere");
    emit panel_->findChild<QTextBrowser*>("explain.text")->anchorClicked(QUrl("action:explain.step-virtual-camera"));
    QCOMPARE(panel_->step(), 2);
    QTRY_VERIFY(!panel_->busy() && panel_->explanation());
    QVERIFY2(text().contains("the model fails"), qPrintable(text()));  // primal on a sphere
  }

  void theWalkPlaysWithoutFillingTheHistory() {
    open("plane-to-cylinder");
    window_->actions().find("explain.step-limit-angles")->trigger();
    WalkPlayer& walk = panel_->walk();
    QTRY_VERIFY(walk.story());
    auto* view = panel_->findChild<WalkView*>();
    QVERIFY(view && view->isVisible());
    auto* slider = view->findChild<QSlider*>("explain.walk-step");
    const int last = walk.story()->steps() - 1;
    QCOMPARE(walk.step(), last);
    QCOMPARE(slider->maximum(), last);
    const int before = window_->document().undoStack()->count();
    QTest::mouseClick(view->findChild<QToolButton*>("explain.play"), Qt::LeftButton);
    QVERIFY(walk.playing());
    QTRY_VERIFY(walk.step() > 3 && walk.step() < last);
    QCOMPARE(window_->document().undoStack()->count(), before);
    QCOMPARE(slider->value(), walk.step());
    window_->actions().find("explain.play-walk")->trigger();
    QVERIFY(!walk.playing());
    QCOMPARE(window_->document().undoStack()->count(), before + 1);
    const int paused = walk.step();
    QCOMPARE(window_->document().option("explain/walk-step", -1.0), double(paused));
    window_->actions().find("explain.walk-on")->trigger();
    QCOMPARE(walk.step(), paused + 1);
    window_->actions().find("explain.walk-back")->trigger();
    QCOMPARE(walk.step(), paused);
    window_->document().undoStack()->undo();
    QCOMPARE(walk.step(), paused + 1);
    window_->document().undoStack()->undo();
    QCOMPARE(walk.step(), paused);
    window_->document().undoStack()->undo();
    QCOMPARE(walk.step(), last);
    // To the end it stops by itself.
    window_->document().setOption("explain/walk-step", double(last - 3), "near the end");
    window_->actions().find("explain.play-walk")->trigger();
    QTRY_VERIFY(!walk.playing());
    QCOMPARE(walk.step(), last);
  }

  void theWalkFollowsTheSelectedDirectionAndTurnsRoundInTheInverseStep() {
    open("plane-to-cylinder");
    window_->actions().find("explain.step-limit-angles")->trigger();
    WalkPlayer& walk = panel_->walk();
    QTRY_VERIFY(walk.story());
    QVERIFY(!walk.story()->inverse);
    for (const double direction : {1.0, -2.0}) {
      viz::Selection s = window_->document().selection();
      s.direction = direction;
      window_->document().select(s);
      QTRY_VERIFY(!walk.busy() && walk.story() &&
                  std::abs(std::remainder(*walk.story()->direction - direction, 6.283185307179586)) < 0.4);
    }
    window_->actions().find("explain.step-inverse-walk")->trigger();
    QTRY_VERIFY(walk.story() && walk.story()->inverse);
    QCOMPARE(walk.story()->model, std::string("canonical"));
    window_->actions().find("explain.step-comparison")->trigger();
    QVERIFY(!walk.story());
    QVERIFY(!panel_->findChild<WalkView*>()->isVisible());
  }

  void theViewGoesToWhatAStepIsAbout() {
    open("sphere");
    viz::SceneView& view = window_->findChild<ScenePanel*>()->view();
    const auto distance = [&] { return (view.viewPoint().position - view.viewPoint().focalPoint).norm(); };
    window_->actions().find("explain.step-peak")->trigger();
    QTRY_VERIFY(!panel_->busy() && panel_->explanation());
    const double far = distance();
    window_->actions().find("explain.step-limit-angles")->trigger();
    QTRY_VERIFY2(distance() < 0.5 * far, "the highlight fills the view");
    const Eigen::Vector3d peak = panel_->explanation()->view->brightest->point.position;
    QVERIFY((view.viewPoint().focalPoint - peak).norm() < 0.2);
    window_->actions().find("explain.step-ellipsoid")->trigger();
    QTRY_VERIFY(distance() > 1.5);
    const viz::ViewPoint there = view.viewPoint();
    viz::ViewPoint orbited = there;
    orbited.position += Eigen::Vector3d(0.1, 0.2, 0);
    view.setViewPoint(orbited);  // the user may look from elsewhere
    window_->document().select(window_->document().selection());
    QTest::qWait(50);
    QVERIFY((view.viewPoint().position - orbited.position).norm() < 1e-9);
  }

 private:
  void open(const QString& id) {
    while (window_->document().undoStack()->canUndo()) window_->document().undoStack()->undo();
    window_->actions().find("lesson." + id)->trigger();
    QTRY_VERIFY_WITH_TIMEOUT(window_->document().option("explain/lesson", std::string()) == id.toStdString(), 60000);
    QTRY_VERIFY_WITH_TIMEOUT(window_->idle() && window_->document().inspection() && !window_->document().stale(), 60000);
  }
  static QString plain(const QString& html) {
    QTextDocument document;
    document.setHtml(html);
    return document.toPlainText();
  }
  QString text() const { return panel_->findChild<QTextBrowser*>("explain.text")->toPlainText(); }

  std::unique_ptr<MainWindow> window_;
  ExplainPanel* panel_ = nullptr;
};

QObject* makeLessonsTest() { return new LessonsTest; }

}  // namespace glint::gui

#include "lessons_test.moc"
