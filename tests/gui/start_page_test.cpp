// SPDX-License-Identifier: BSD-3-Clause
// What a person meets first: the start page, by keyboard alone; and the window in front of an audience.
#include "gui/window/start_page.h"

#include <QLabel>
#include <QMenuBar>
#include <QPushButton>
#include <QScrollArea>
#include <QToolBar>

#include "gui/explain/explain_panel.h"
#include "gui/explain/lessons.h"
#include "gui/frame/develop_bar.h"
#include "gui/timeline/timeline.h"
#include "gui/window/main_window.h"
#include "tests/gui/window_fixture.h"

namespace glint::gui {

class StartPageTest : public QObject, WindowFixture {
  Q_OBJECT
 private slots:
  void initTestCase() { qputenv("GLINT_LESSONS", GLINT_SOURCE_DIR "/sessions/lessons"); }

  void nothingStandsAroundItUntilSomethingIsOpen() {
    MainWindow window(fixture_.engine());
    show(window);
    QVERIFY(seen(window).isEmpty());
    const QString what = window.findChild<QLabel*>("start.what")->text();
    QCOMPARE(what.split(' ').size(), 10);
    openAndWait(window);
    QStringList names;
    for (const QDockWidget* dock : seen(window)) names << dock->objectName();
    for (const char* dock : {"setup", "parameters", "timeline", "errors"}) QVERIFY2(names.contains(dock), dock);
    QVERIFY(!window.findChild<StartPage*>()->isVisible());
  }

  void everyLessonAndSessionHasATileWithItsPicture() {
    MainWindow window(fixture_.engine());
    show(window);
    const QList<Tile*> tiles = window.findChildren<Tile*>();
    QCOMPARE(tiles.size(), lessons().size() + 5);
    for (Tile* tile : tiles) {
      QVERIFY2(!tile->accessibleName().isEmpty() && tile->hasPicture(), qPrintable(tile->text()));
      QVERIFY2(tile->focusPolicy() & Qt::TabFocus, qPrintable(tile->text()));
    }
  }

  void theKeyboardReachesAndOpensEverything() {
    MainWindow window(fixture_.engine());
    show(window);
    QApplication::setActiveWindow(&window);
    QTRY_COMPARE(QApplication::activeWindow(), static_cast<QWidget*>(&window));
    auto* page = window.findChild<StartPage*>();
    const QList<Tile*> tiles = page->findChildren<Tile*>();
    QList<QWidget*> reached;
    tiles.front()->setFocus(Qt::TabFocusReason);
    const QImage focused = tiles.front()->grab().toImage();
    for (int i = 0; i < tiles.size(); ++i) {
      reached << window.focusWidget();
      QTest::keyClick(window.focusWidget(), Qt::Key_Tab);
    }
    for (Tile* tile : tiles) QVERIFY2(reached.contains(tile), qPrintable(tile->text()));
    QVERIFY2(tiles.front()->grab().toImage() != focused, "where the keyboard is can be seen");
    // Arrows: to the neighbours, down and up to the next rows.
    tiles.front()->setFocus();
    QTest::keyClick(tiles.front(), Qt::Key_Right);
    QCOMPARE(window.focusWidget(), static_cast<QWidget*>(tiles[1]));
    QTest::keyClick(tiles[1], Qt::Key_Left);
    QCOMPARE(window.focusWidget(), static_cast<QWidget*>(tiles[0]));
    QTest::keyClick(tiles[0], Qt::Key_Down);
    QVERIFY(window.focusWidget() != tiles[0] && window.focusWidget()->y() >= 0);
    QTest::keyClick(window.focusWidget(), Qt::Key_Up);
    QCOMPARE(window.focusWidget(), static_cast<QWidget*>(tiles[0]));
    QTest::keyClick(tiles[0], Qt::Key_Up);
    QVERIFY(qobject_cast<QPushButton*>(window.focusWidget()));
    QStringList asked;
    connect(page, &StartPage::openRecent, this, [&](const QString& file) { asked << file; });
    tiles[2]->setFocus();
    QTest::keyClick(tiles[2], Qt::Key_Return);
    QCOMPARE(asked, QStringList{lessonFile(lessons()[2].id)});
  }

  /// Full screen, large texts, a remote control; everything as before when it ends.
  void presentingGivesBackWhatWasThere() {
    MainWindow window(fixture_.engine());
    openActive(window);
    const auto names = [&] {
      QStringList all;
      for (const QDockWidget* dock : seen(window)) all << dock->objectName();
      all.sort();
      return all;
    };
    const QStringList before = names();
    const QFont font = QApplication::font();
    const QSize size = window.size();
    auto* const tools = window.findChild<QToolBar*>("tools");
    auto* const timeline = window.findChild<QDockWidget*>("timeline");
    QVERIFY(tools && !tools->isHidden() && timeline);
    QWidget* const text = timeline->widget();
    const double small = QFontInfo(text->font()).pointSizeF();
    QAction* present = window.actions().find("view.present");
    present->trigger();
    QTRY_VERIFY(window.isFullScreen() && present->isChecked());
    QVERIFY(QApplication::font().pointSizeF() > 1.3 * font.pointSizeF());
    QVERIFY(window.menuBar()->isHidden() && tools->isHidden() && names() == QStringList{"timeline"});
    // Text in a dock, whose title has a font of its own, grows, too; and the views have most of the screen.
    QVERIFY2(QFontInfo(text->font()).pointSizeF() > 1.3 * small,
             qPrintable(QString::number(QFontInfo(text->font()).pointSizeF())));
    QTRY_VERIFY2(timeline->height() < window.height() * 2 / 5, qPrintable(QString::number(timeline->height())));
    // Nothing is cut off: beside the timeline's chart, beside the frame view's sliders.
    auto* const strip = window.findChild<TimelineStrip*>("timelineStrip");
    QTRY_VERIFY(strip->axisFits());
    const QList<QLabel*> labels = window.findChild<DevelopBar*>()->findChildren<QLabel*>();
    QCOMPARE(labels.size(), 2);
    for (const QLabel* label : labels)
      QTRY_VERIFY2(label->fontMetrics().horizontalAdvance(label->text()) <= label->width(), qPrintable(label->text()));
    const int frame = window.document().selection().frame;
    QTest::keyClick(window.focusWidget() ? window.focusWidget() : &window, Qt::Key_PageDown);
    QCOMPARE(window.document().selection().frame, frame + 1);
    QTest::keyClick(&window, Qt::Key_PageUp);
    QCOMPARE(window.document().selection().frame, frame);
    QTest::keyClick(&window, Qt::Key_B);
    QVERIFY(window.findChild<QWidget*>("present.black"));
    QTest::keyClick(&window, Qt::Key_Escape);  // first the picture again
    QVERIFY(!window.findChild<QWidget*>("present.black") && window.isFullScreen());
    QTest::keyClick(&window, Qt::Key_Escape);
    QTRY_VERIFY(!window.isFullScreen() && !present->isChecked());
    QCOMPARE(QApplication::font(), font);
    QCOMPARE(QFontInfo(text->font()).pointSizeF(), small);
    QVERIFY(!window.menuBar()->isHidden());
    QTRY_VERIFY(!tools->isHidden());
    QTRY_COMPARE(names(), before);
    QTRY_COMPARE(window.size(), size);
  }
};

QObject* makeStartPageTest() { return new StartPageTest; }

}  // namespace glint::gui

#include "start_page_test.moc"
