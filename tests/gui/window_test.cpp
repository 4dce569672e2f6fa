// SPDX-License-Identifier: BSD-3-Clause
#include <QAbstractButton>
#include <QAction>
#include <QApplication>
#include <QCheckBox>
#include <QClipboard>
#include <QContextMenuEvent>
#include <QDockWidget>
#include <QDoubleSpinBox>
#include <QHelpEvent>
#include <QLabel>
#include <QLineEdit>
#include <QListView>
#include <QListWidget>
#include <QPlainTextEdit>
#include <QPushButton>
#include <QScreen>
#include <QScrollArea>
#include <QScrollBar>
#include <QSet>
#include <QSettings>
#include <QSignalSpy>
#include <QSplitter>
#include <QStackedWidget>
#include <QStatusBar>
#include <QTableView>
#include <QTimer>
#include <QToolButton>
#include <QToolTip>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "gui/base/panel_scroll.h"
#include "gui/base/text.h"
#include "gui/base/vtk_canvas.h"
#include "gui/explain/explain_panel.h"
#include "gui/frame/frame_canvas.h"
#include "gui/frame/frame_panel.h"
#include "gui/frame/ladder_panel.h"
#include "gui/panels/log_panel.h"
#include "gui/plots/plot_canvas.h"
#include "gui/window/layouts.h"
#include "gui/window/main_window.h"
#include "gui/window/message_bar.h"
#include "tests/gui/window_fixture.h"

namespace glint::gui {

class WindowTest : public QObject, WindowFixture {
  Q_OBJECT
 private slots:
  void anEmptyWindowSaysWhatToDo() {
    MainWindow window(fixture_.engine());
    show(window);
    bool offered = false;
    for (const QPushButton* button : window.findChildren<QPushButton*>())
      offered |= button->isVisible() && button->text().contains("Open scene");
    QVERIFY(offered);
    QTRY_VERIFY(window.idle());
    QVERIFY(!window.picture().isNull());
  }

  /// A hidden page counts for the least height of the views, and takes it from the docks below them.
  void theStartPageDoesNotKeepTheViewsHigh() {
    MainWindow window(fixture_.engine());
    auto* pages = window.centralWidget()->findChild<QStackedWidget*>();
    QVERIFY(pages);
    QVERIFY(pages->widget(0)->minimumSizeHint().height() < 200);
  }

  /// A single such widget makes every update of every widget a composition of the whole window by OpenGL.
  void noWidgetIsAnOpenGlWidget() {
    MainWindow window(fixture_.engine());
    show(window);
    openAndWait(window);
    QVERIFY(!window.findChildren<VtkCanvas*>().isEmpty());
    for (const QWidget* widget : window.findChildren<QWidget*>())
      QVERIFY2(!widget->inherits("QOpenGLWidget"), widget->metaObject()->className());
  }

  void tabLeavesEveryWidgetAndReachesTheViews() {
    MainWindow window(fixture_.engine());
    openActive(window);
    auto* table = window.findChild<QTableView*>(QStringLiteral("errorTable"));
    table->setFocus();
    table->setCurrentIndex(table->model()->index(0, 0));
    QSet<QWidget*> reached;
    constexpr int kMost = 1000;  // more than the window has
    constexpr int kLinks = 12;   // a text goes to its links first
    int presses = 0, same = 0;
    do {
      QWidget* before = QApplication::focusWidget();
      QVERIFY(before);
      QTest::keyClick(before, Qt::Key_Tab);
      QWidget* now = QApplication::focusWidget();
      same = now == before ? same + 1 : 0;
      QVERIFY2(now && same < kLinks, qPrintable(before->objectName() + " of " + before->metaObject()->className()));
      reached << now;
    } while (QApplication::focusWidget() != table && ++presses < kMost);
    QVERIFY(presses < kMost);
    for (const QTableView* any : window.findChildren<QTableView*>())  // those of docks that are not shown now, too
      QVERIFY2(!any->tabKeyNavigation(), qPrintable(any->objectName()));
    for (const char* name : {"timelineStrip", "frameCanvas", "sceneView"}) {
      auto* view = window.findChild<QWidget*>(QLatin1String(name));
      QVERIFY2(view, name);
      const bool shown = !view->visibleRegion().isEmpty();
      QVERIFY2(shown || window.devicePixelRatioF() > 1, name);  // at 200 % docks lie behind each other
      const auto within = [&](QWidget* w) { return w == view || view->isAncestorOf(w); };
      QVERIFY2(std::any_of(reached.begin(), reached.end(), within) == shown, name);
    }
  }

  void tabGoesPastWhatLiesBehindAnotherTabAndChoosesNothing() {
    MainWindow window(fixture_.engine());
    openActive(window);
    const int steps = window.document().undoStack()->count();
    const auto* explain = window.findChild<ExplainPanel*>();
    auto* start = window.findChild<QWidget*>(QStringLiteral("timelineStrip"));
    QVERIFY(explain && start);
    for (const bool next : {true, false}) {
      start->setFocus();
      for (int i = 0; i < 60; ++i) {
        QTest::keyClick(QApplication::focusWidget(), next ? Qt::Key_Tab : Qt::Key_Backtab);
        QVERIFY(QApplication::focusWidget());
        QVERIFY2(!explain->isAncestorOf(QApplication::focusWidget()), qPrintable(QApplication::focusWidget()->objectName()));
      }
    }
    QCOMPARE(window.document().undoStack()->count(), steps);
    // In front, its list has the focus without a step being chosen; a key chooses.
    window.findChild<QDockWidget*>(QStringLiteral("explain"))->raise();
    auto* list = window.findChild<QListWidget*>(QStringLiteral("explain.steps"));
    list->setFocus(Qt::TabFocusReason);
    QCOMPARE(window.document().undoStack()->count(), steps);
    QTest::keyClick(list, Qt::Key_Down);
    QCOMPARE(window.document().undoStack()->count(), steps + 1);
  }

  void buttonsOfPanelsAreActionsToo() {
    MainWindow window(fixture_.engine());
    show(window);
    openAndWait(window);
    for (const auto& [id, name] : {std::pair{"edit.auto-model", "autoModel"}, std::pair{"edit.what-if-back", "whatif.reset"},
                                   std::pair{"plots.measure", "measureTradeoff"}}) {
      auto* button = window.findChild<QAbstractButton*>(QLatin1String(name));
      QVERIFY2(button && window.actions().find(QLatin1String(id)), id);
      QSignalSpy clicked(button, &QAbstractButton::clicked);
      button->setEnabled(true);
      window.actions().find(QLatin1String(id))->trigger();
      QCOMPARE(clicked.count(), 1);
      QTRY_VERIFY_WITH_TIMEOUT(window.idle(), 20000);
    }
    QTRY_VERIFY(seen(window).contains(window.findChild<QDockWidget*>(QStringLiteral("tradeoff"))));  // where the result will be
  }

  void theLogHasItsReportAtHand() {
    MainWindow window(fixture_.engine());
    show(window);
    openAndWait(window);
    QApplication::clipboard()->clear();
    auto* button = window.findChild<QToolButton*>(QStringLiteral("copyDiagnostic"));
    QVERIFY(button);
    window.findChild<QDockWidget*>(QStringLiteral("log"))->raise();
    QCoreApplication::processEvents();
    const auto* text = window.findChild<QPlainTextEdit*>();
    const auto placeOf = [&](const QWidget* w) { return QRect(w->mapTo(&window, QPoint()), w->size()); };
    QVERIFY(text && button->isVisible() && window.findChild<QDockWidget*>(QStringLiteral("log"))->isAncestorOf(button));
    QVERIFY2(!placeOf(button).intersects(placeOf(text)), "it covers the text");
    button->click();
    QVERIFY2(QApplication::clipboard()->text().contains(QStringLiteral("Opened")), "the log is in it");
  }

  void aSceneIsOpenedComputedAndShown() {
    MainWindow window(fixture_.engine());
    show(window);
    openAndWait(window);
    QVERIFY(!window.document().stale());
    QCOMPARE(window.findChild<QTableView*>(QStringLiteral("errorTable"))->model()->rowCount(),
             12 * int(window.document().request().models.size()));
    QVERIFY(window.findChild<QWidget*>(QStringLiteral("sceneView"))->isVisible());
    QVERIFY(window.windowTitle().startsWith(toQString(window.document().scene()->name) + "[*]"));
  }

  void aParameterChangesTheResultOffTheInterfaceThread() {
    Engine engine = fixture_.engine();
    QThread* interfaceThread = QThread::currentThread();
    std::atomic<bool> elsewhere{true};
    engine.ask = [inner = engine.ask, interfaceThread, &elsewhere](Pipeline& pipeline, const Question& q, const ProgressFn& p) {
      if (QThread::currentThread() == interfaceThread) elsewhere = false;
      return inner(pipeline, q, p);
    };
    MainWindow window(engine);
    show(window);
    openAndWait(window);
    auto* box = window.findChild<QDoubleSpinBox*>(QStringLiteral("value:detect.level"));
    box->setFocus();
    box->selectAll();
    QTest::keyClicks(box, "0.2");
    QTest::keyClick(box, Qt::Key_Return);
    QVERIFY(window.document().stale());
    QTRY_VERIFY(window.idle() && !window.document().stale());
    QCOMPARE(window.document().inspection()->evidence[0].highlights[0].level, 0.2);
    window.document().undoStack()->undo();
    QTRY_VERIFY(window.idle() && !window.document().stale());
    QCOMPARE(window.document().inspection()->evidence[0].highlights[0].level, 0.5);
    QVERIFY(elsewhere);
  }

  void aClickWithTheRightButtonOffersWhatOneDoesThere() {
    MainWindow window(fixture_.engine());
    show(window);
    openAndWait(window);
    const auto offers = [&](const QWidget* view, const char* id) {
      return view->contextMenuPolicy() != Qt::NoContextMenu && view->actions().contains(window.actions().find(id));
    };
    for (const FrameCanvas* canvas : window.findChild<FramePanel*>()->findChildren<FrameCanvas*>())
      QVERIFY(offers(canvas, "frame.highlight"));
    auto* photograph = window.findChild<FramePanel*>()->canvas();
    QContextMenuEvent there(QContextMenuEvent::Mouse, {20, 20}, photograph->mapToGlobal(QPoint(20, 20)));
    QApplication::sendEvent(photograph, &there);
    auto* frameMenu = photograph->findChild<QMenu*>(QStringLiteral("frameMenu"));
    QVERIFY(frameMenu && frameMenu->isVisible() && frameMenu->toolTipsVisible());
    QVERIFY(frameMenu->actions().contains(window.actions().find("frame.grow-highlight")));
    frameMenu->close();
    const QList<PlotCanvas*> plots = window.findChildren<PlotCanvas*>();
    QVERIFY(!plots.isEmpty());
    // A menu that opens is closed again by a timer: it runs an event loop of its own.
    QStringList titles;
    QTimer::singleShot(300, &window, [&] {
      if (QWidget* menu = QApplication::activePopupWidget()) {
        for (const QAction* action : menu->actions()) titles << action->text();
        menu->close();
      }
    });
    QContextMenuEvent click(QContextMenuEvent::Mouse, {20, 20}, plots.front()->mapToGlobal(QPoint(20, 20)));
    QApplication::sendEvent(plots.front(), &click);
    QVERIFY(titles.contains(window.actions().find("plots.copy-svg")->text()));
  }

  /// Qt's fields take the keys of undo for themselves, also when there is nothing left in them to undo.
  void theKeysOfUndoTakeBackWhatWasEntered() {
    MainWindow window(fixture_.engine());
    openActive(window);
    Document& document = window.document();
    auto* box = window.findChild<QDoubleSpinBox*>(QStringLiteral("value:detect.level"));
    box->setFocus();
    box->selectAll();
    QTest::keyClicks(box, "0.2");
    QTest::keyClick(box, Qt::Key_Z, Qt::ControlModifier);  // not entered yet: the field's own
    QCOMPARE(document.request().settings.number("detect.level"), 0.5);
    box->selectAll();
    QTest::keyClicks(box, "0.2");
    QTest::keyClick(box, Qt::Key_Return);
    QCOMPARE(document.request().settings.number("detect.level"), 0.2);
    const int steps = document.undoStack()->index();
    QVERIFY(box->hasFocus());
    QTest::keyClick(box, Qt::Key_Z, Qt::ControlModifier);
    QCOMPARE(document.undoStack()->index(), steps - 1);
    QCOMPARE(document.request().settings.number("detect.level"), 0.5);
    QTest::keyClick(box, Qt::Key_Z, Qt::ControlModifier | Qt::ShiftModifier);
    QCOMPARE(document.request().settings.number("detect.level"), 0.2);
    // A search: first what was typed there, then what was done.
    window.findChild<QDockWidget*>(QStringLiteral("tree"))->raise();
    auto* search = window.findChild<QLineEdit*>(QStringLiteral("treeSearch"));
    search->setFocus();
    QTest::keyClicks(search, "0");
    QTest::keyClick(search, Qt::Key_Z, Qt::ControlModifier);
    QVERIFY(search->text().isEmpty());
    QCOMPARE(document.undoStack()->index(), steps);
    QTest::keyClick(search, Qt::Key_Z, Qt::ControlModifier);
    QCOMPARE(document.undoStack()->index(), steps - 1);
    // In a tab that goes behind another one it takes no keys any more.
    QVERIFY(search->hasFocus());
    window.findChild<QDockWidget*>(QStringLiteral("history"))->raise();
    QTRY_VERIFY(!search->hasFocus());
    QVERIFY(QApplication::focusWidget());
  }

  void anOwnLayoutComesBackInThisWindowAndTheNext() {
    QSettings().remove(QStringLiteral("layouts"));
    MainWindow window(fixture_.engine());
    show(window);
    openAndWait(window);
    QVERIFY(!window.actions().find("view.layout-own-2")->isEnabled());
    auto* plots = window.findChild<QDockWidget*>(QStringLiteral("plots"));
    auto* setup = window.findChild<QDockWidget*>(QStringLiteral("setup"));
    window.addDockWidget(Qt::RightDockWidgetArea, setup);
    plots->hide();
    QSplitter* views = viewsOf(window);
    views->setSizes({200, 600});
    QTest::qWait(20);
    const double share = shareOfFirst(views);
    window.actions().find("view.layout-keep-2")->trigger();
    window.applyLayout(QStringLiteral("compare"));
    views->setSizes({600, 200});
    QVERIFY(shareOfFirst(views) > share + 0.2);
    QVERIFY(plots->isVisible());
    QVERIFY(window.actions().find("view.layout-own-2")->isEnabled());
    window.actions().find("view.layout-own-2")->trigger();
    QVERIFY(!plots->isVisible() && setup->isVisible());
    QCOMPARE(window.dockWidgetArea(setup), Qt::RightDockWidgetArea);
    QTRY_VERIFY2(std::abs(shareOfFirst(views) - share) < 0.05, qPrintable(QString::number(shareOfFirst(views))));
    MainWindow next(fixture_.engine());
    show(next);
    next.actions().find("view.layout-own-2")->trigger();
    QVERIFY(next.findChild<QDockWidget*>(QStringLiteral("plots"))->isHidden());
    QSettings().remove(QStringLiteral("layouts"));
  }

  void stopLeavesTheOldResultsMarkedAsOutOfDate() {
    Engine engine = fixture_.engine();
    engine.ask = [inner = engine.ask](Pipeline& pipeline, const Question& q, const ProgressFn& p) {
      for (int i = 0; q.request.settings.number("detect.level") < 0.3 && i < 6000; ++i) {
        if (!report(p, {"detect", i, 6000})) throw Stopped{};
        QThread::msleep(10);
      }
      return inner(pipeline, q, p);
    };
    MainWindow window(engine);
    show(window);
    openAndWait(window);
    const auto before = window.document().inspection();
    window.document().setSetting("detect.level", 0.2);
    auto* stop = window.findChild<QToolButton*>(QStringLiteral("stop"));
    QTRY_VERIFY(stop->isVisible());
    QTest::qWait(50);
    QTest::mouseClick(stop, Qt::LeftButton);
    QTRY_VERIFY(window.idle());
    QVERIFY(window.document().stale());
    QVERIFY(window.document().inspection() == before);
    // The status line and the badges say so, and that nothing runs any more.
    QTRY_VERIFY(!stop->isVisible());
    QCOMPARE(window.findChild<QLabel*>(QStringLiteral("jobText"))->text(), QStringLiteral("results are out of date"));
    for (const QLabel* badge : window.findChildren<QLabel*>(QStringLiteral("staleBadge")))
      QCOMPARE(badge->text(), QStringLiteral("out of date"));
    window.document().undoStack()->undo();
    QTRY_VERIFY(window.idle() && !window.document().stale());
    for (const QLabel* badge : window.findChildren<QLabel*>(QStringLiteral("staleBadge")))
      QCOMPARE(badge->text(), QStringLiteral("updating…"));
  }

  /// A success says so, and removes the message of an earlier failure.
  void successTakesTheErrorAway() {
    MainWindow window(fixture_.engine());
    show(window);
    openAndWait(window);
    auto* bar = window.findChild<MessageBar*>();
    window.actions().find("export.window-command")->trigger();  // without a session: refused
    QTRY_VERIFY(bar->isVisible());
    window.document().markSaved(QStringLiteral("kept.glint"), window.document().state());
    window.actions().find("export.window-command")->trigger();
    QVERIFY(!bar->isVisible());
    QTRY_VERIFY(window.statusBar()->currentMessage().contains(QStringLiteral("kept.glint")));
    QVERIFY(window.windowTitle().contains(QStringLiteral(" (kept.glint)[*]")));
  }

  void parametersWaitForAScene() {
    MainWindow window(fixture_.engine());
    show(window);
    auto* box = window.findChild<QDoubleSpinBox*>(QStringLiteral("value:detect.level"));
    auto* hint = window.findChild<QLabel*>(QStringLiteral("parametersHint"));
    QWidget* const panel = hint->parentWidget();  // docks come with a scene, unless one asks for them
    QVERIFY(!box->isEnabled() && hint->isVisibleTo(panel));
    openAndWait(window);
    QVERIFY(box->isEnabled() && box->isVisibleTo(&window) && !hint->isVisibleTo(&window));
  }

  /// An error that comes while something is offered (to recover what was lost) does not take the offer away.
  void anOfferComesBackAfterAnError() {
    MessageBar bar;
    bar.show();
    int taken = 0;
    const auto close = [&] {
      for (QToolButton* button : bar.findChildren<QToolButton*>())
        if (button->toolTip() == QStringLiteral("Close")) button->click();
    };
    const auto press = [&](const char* title) {
      QCoreApplication::sendPostedEvents(nullptr, QEvent::DeferredDelete);  // the buttons of before
      for (QPushButton* button : bar.findChildren<QPushButton*>())
        if (button->text() == QLatin1String(title)) return button->click();
      QFAIL(title);
    };
    const auto offer = [&] { bar.showOffer(QStringLiteral("offer"), {{QStringLiteral("Take"), [&] { ++taken; }}}); };
    offer();
    bar.showError(QStringLiteral("first"));
    bar.showError(QStringLiteral("second"), {{QStringLiteral("Locate"), [] {}}});
    press("Locate");
    QVERIFY(!bar.isHidden());
    QCOMPARE(bar.text(), QStringLiteral("offer"));
    bar.showError(QStringLiteral("third"));
    close();
    QCOMPARE(bar.text(), QStringLiteral("offer"));
    press("Take");
    QVERIFY(bar.isHidden() && taken == 1);
    bar.showError(QStringLiteral("fourth"));
    close();
    QVERIFY(bar.isHidden());  // taken once, offered once
    offer();
    close();
    bar.showError(QStringLiteral("fifth"), {{QStringLiteral("Again"), [&] { bar.showError(QStringLiteral("sixth")); }}});
    press("Again");
    QCOMPARE(bar.text(), QStringLiteral("sixth"));
    close();
    QVERIFY(bar.isHidden());
  }

  /// A reason in the narrow column of the table wrapped there, and pushed the models below it out of sight.
  void reasonsStandBelowTheModels() {
    MainWindow window(fixture_.engine());
    show(window);
    openAndWait(window);
    const int frame = window.document().frameCount() - 1;  // whose predictions fail
    window.document().selectFrame(frame);
    const auto* label = window.findChild<QLabel*>(QStringLiteral("frameCaptions"));
    int reasons = 0;
    for (const draw::OverlayCaption& c : draw::frameOverlay(*window.document().inspection(), frame, {}).captions) {
      const QString sentence = toQString(c.score.reason).section(QStringLiteral(": "), 1);
      if (c.model.empty() || sentence.isEmpty()) continue;
      ++reasons;
      QTRY_VERIFY(label->text().contains(sentence.toHtmlEscaped()));
      QVERIFY(label->text().indexOf(sentence.toHtmlEscaped()) > label->text().lastIndexOf(QStringLiteral("</table>")));
    }
    QVERIFY(reasons > 0);
  }

  /// The selected frame comes first, and views of that frame alone show it then.
  void theLadderAndTheDialDoNotWaitForTheOtherFrames() {
    Engine engine = fixture_.engine();
    std::atomic<bool> hold{true}, holdFrame{true};
    engine.ask = [&hold, &holdFrame](Pipeline& pipeline, const Question& q, const ProgressFn&) -> Pipeline::Answer {
      if (q.part == Question::Part::FirstLook) return nullptr;
      const std::atomic<bool>& holds = q.part == Question::Part::Frame ? holdFrame : hold;
      while (holds) QThread::msleep(5);
      return drawn(pipeline, q);
    };
    MainWindow window(engine);
    show(window);
    window.applyLayout(QStringLiteral("compare"));
    window.open(toQString(fixture_.opened().path));
    QTRY_VERIFY(window.document().scene() != nullptr);
    const auto* ladder = window.findChild<LadderPanel*>();
    const auto shown = [&] { return ladder->canvases().size() == window.document().request().models.size(); };
    QTest::qWait(200);  // nothing is left over that would draw them anyway
    const bool tooEarly = shown() || window.document().frameInspection();
    holdFrame = false;
    QTRY_VERIFY(window.document().frameInspection() != nullptr);
    QTest::qWait(200);
    const bool early = shown() && !window.document().inspection();
    const auto dial = [&window] {
      for (const PlotCanvas* canvas : window.findChildren<PlotCanvas*>())
        if (canvas->plot().id == "dial") return canvas->plot().empty;
      return std::string("no dial");
    };
    const std::string earlyDial = dial();
    hold = false;
    QVERIFY(early && !tooEarly);
    QTRY_VERIFY(window.idle() && window.document().inspection());
    QVERIFY(shown());
    QCOMPARE(earlyDial, dial());
  }

  /// A bug in a job does not end the program, and does not go unseen.
  void whatNobodyExpectedIsToldOnce() {
    Engine engine = fixture_.engine();
    engine.contour = [](const Pipeline&, const InspectionRequest&, int, const ProgressFn&,
                        const Inspection*) -> std::optional<Observation> { throw std::runtime_error("an empty vector"); };
    MainWindow window(engine);
    show(window);
    openAndWait(window);
    const auto told = [&] { return window.findChild<LogPanel*>()->text().count("Unexpected failure: an empty vector"); };
    window.document().setSetting("detect.level", 0.3);
    QTRY_COMPARE(told(), 1);
    QTRY_VERIFY(window.statusBar()->currentMessage().contains("an empty vector"));
    window.document().setSetting("detect.level", 0.4);
    QTRY_VERIFY(window.idle());
    QCOMPARE(told(), 1);
    QVERIFY(window.lastError().isEmpty());
  }

  void historyEntriesThatAreCutHaveTheirTextAsToolTip() {
    MainWindow window(fixture_.engine());
    show(window);
    openAndWait(window);
    window.document().setModels({"reflectance", "limit-angle", "canonical", "dual", "primal"});
    window.findChild<QDockWidget*>(QStringLiteral("history"))->raise();
    auto* list = window.findChild<QListView*>(QStringLiteral("historyList"));
    QTRY_VERIFY(list->isVisible());
    const QModelIndex last = list->model()->index(list->model()->rowCount() - 1, 0);
    list->scrollTo(last);
    QVERIFY(list->fontMetrics().horizontalAdvance(last.data().toString()) > list->viewport()->width());
    QVERIFY(!list->horizontalScrollBar()->isVisible());
    QVERIFY(list->visualRect(last).width() <= list->viewport()->width());
    const QPoint at = list->visualRect(last).center();
    QHelpEvent help(QEvent::ToolTip, at, list->viewport()->mapToGlobal(at));
    QCoreApplication::sendEvent(list->viewport(), &help);
    QTRY_COMPARE(QToolTip::text(), last.data().toString());
    QToolTip::hideText();
    QTRY_VERIFY(!QToolTip::isVisible());
    const QModelIndex whole = list->model()->index(0, 0);  // "As opened"
    list->scrollTo(whole);
    const QPoint over = list->visualRect(whole).center();
    QHelpEvent none(QEvent::ToolTip, over, list->viewport()->mapToGlobal(over));
    QCoreApplication::sendEvent(list->viewport(), &none);
    QVERIFY(!QToolTip::isVisible());
  }

  void theLayersDockFollowsTheViewThatIsWorkedIn() {
    MainWindow window(fixture_.engine());
    show(window);
    openAndWait(window);
    window.actions().find("view.views-2")->trigger();
    auto* own = window.findChild<QCheckBox*>(QStringLiteral("ownLayers"));
    auto* view = window.findChild<QWidget*>(QStringLiteral("sceneView"));
    for (const auto& [x, name] : {std::pair(3, "View B"), std::pair(1, "View A")}) {
      QTest::mouseClick(view, Qt::LeftButton, {}, {x * view->width() / 4, view->height() / 2});
      QVERIFY2(own->text().contains(name), qPrintable(own->text()));
    }
  }

  /// Two numbers in px of one prediction: each says which it is (the other one is the dial's, see the tests of plots).
  void theErrorTableSaysWhatItsPixelsMeasure() {
    MainWindow window(fixture_.engine());
    const QAbstractItemModel* model = window.findChild<QTableView*>(QStringLiteral("errorTable"))->model();
    QString tip;
    for (int c = 0; c < model->columnCount(); ++c)
      if (model->headerData(c, Qt::Horizontal).toString() == "Error px")
        tip = model->headerData(c, Qt::Horizontal, Qt::ToolTipRole).toString();
    QVERIFY2(tip.contains("Mean contour distance") && tip.contains("without sign") && tip.contains("signed distance"),
             qPrintable(tip));
  }

  void aWrongInputIsAMessageAndKeepsWhatIsOpen() {
    MainWindow window(fixture_.engine());
    show(window);
    openAndWait(window);
    window.open(QStringLiteral("nowhere.json"));
    QTRY_VERIFY(window.idle());
    auto* bar = window.findChild<MessageBar*>(QStringLiteral("messageBar"));
    QVERIFY(bar->isVisible());
    QVERIFY(bar->text().contains("nowhere.json"));
    QVERIFY(window.document().scene() != nullptr);
  }

  void layersAreToggledAndUndone() {
    MainWindow window(fixture_.engine());
    show(window);
    openAndWait(window);
    auto* layers = window.findChild<QListWidget*>(QStringLiteral("layers"));
    QVERIFY(layers->count() >= 14);
    QListWidgetItem* first = layers->item(0);
    const std::string name = first->data(Qt::UserRole).toString().toStdString();
    const bool before = window.document().layerVisible(name);
    first->setCheckState(before ? Qt::Unchecked : Qt::Checked);
    QCOMPARE(window.document().layerVisible(name), !before);
    window.document().undoStack()->undo();
    QCOMPARE(first->checkState() == Qt::Checked, before);
  }

 private:
  /// Scene and frame beside each other.
  static QSplitter* viewsOf(MainWindow& window) { return qobject_cast<QSplitter*>(window.framePanel()->parentWidget()); }
  static double shareOfFirst(const QSplitter* views) {
    const QList<int> sizes = views->sizes();
    return double(sizes[0]) / std::max(1, sizes[0] + sizes[1]);
  }
};

QObject* makeWindowTest() { return new WindowTest; }

}  // namespace glint::gui

#include "window_test.moc"
