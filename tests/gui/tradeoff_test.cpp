// SPDX-License-Identifier: BSD-3-Clause
// The plot of speed against accuracy and the automatic choice, by clicks.
#include <QLabel>
#include <QPushButton>
#include <QSignalSpy>

#include "core/app/session.h"
#include "gui/document/session_file.h"
#include "gui/panels/setup_panel.h"
#include "gui/panels/tradeoff_panel.h"
#include "gui/window/main_window.h"
#include "tests/gui/fixture.h"

namespace glint::gui {

namespace {
/// Three points: 12 directions (fast), 36 (beaten), another model (exact).
Tradeoff threePoints() {
  Tradeoff t;
  t.trainSpec = "first:6";
  t.knobs = {"predict.directions"};
  for (const auto& [model, directions, error, us] :
       {std::tuple{"canonical", "12", 2.0, 20.0}, std::tuple{"canonical", "36", 3.0, 60.0},
        std::tuple{"limit-angle", "36", 0.2, 900.0}}) {
    TradeoffPoint p;
    p.model = model;
    p.settings.setFromText("predict.directions", directions);
    p.contourErrorPct = p.rankedErrorPct = error;
    p.predictUs = us;
    p.pareto = error != 3.0;
    t.points.push_back(p);
  }
  t.presets = {{"fast", 0}, {"balanced", 0}, {"exact", 2}};
  t.chosen = 0;
  t.reason = "for a test, within 12.5 us a frame";
  return t;
}
}  // namespace

class TradeoffTest : public QObject {
  Q_OBJECT
 private slots:
  void aClickLoadsTheSettingAndUndoTakesItBack() {
    Document document(parseTrainSpec);
    TradeoffPanel panel(document);
    Opened opened = fixture_.opened();
    opened.tradeoff = std::make_shared<const Tradeoff>(threePoints());
    document.open(opened);
    panel.resize(700, 260);
    panel.show();
    QVERIFY(QTest::qWaitForWindowExposed(&panel));
    const InspectionRequest before = document.request();
    QSignalSpy changed(&document, &Document::requestChanged);
    TradeoffPlot* plot = panel.plot();
    QTest::mouseClick(plot, Qt::LeftButton, {}, plot->placeOf(0)->toPoint());
    QCOMPARE(changed.count(), 1);
    QCOMPARE(document.request().models, std::vector<std::string>{"canonical"});
    QCOMPARE(document.request().settings.integer("predict.directions"), 12);
    QVERIFY(document.isLoaded(document.tradeoff()->points[0]));
    document.undoStack()->undo();
    QVERIFY(document.request() == before);
    // Beside every point nothing happens.
    QTest::mouseClick(plot, Qt::LeftButton, {}, QPoint(plot->width() / 2, 3));
    QCOMPARE(changed.count(), 2);
    // More to the right is slower, higher up is worse.
    QVERIFY(plot->placeOf(0)->x() < plot->placeOf(1)->x());
    QVERIFY(plot->placeOf(2)->y() > plot->placeOf(1)->y());
  }

  void presetsAndKeys() {
    Document document(parseTrainSpec);
    TradeoffPanel panel(document);
    document.open(fixture_.opened());
    auto* exact = panel.findChild<QPushButton*>(QStringLiteral("preset_exact"));
    QVERIFY(!exact->isEnabled());
    document.setTradeoff(std::make_shared<const Tradeoff>(threePoints()));
    QVERIFY(document.hasUnsavedChanges());
    // Two presets of one setting share a button, and the sentence says it.
    auto* fast = panel.findChild<QPushButton*>(QStringLiteral("preset_fast"));
    QCOMPARE(fast->text(), QStringLiteral("fast and balanced"));
    QVERIFY(!panel.findChild<QPushButton*>(QStringLiteral("preset_balanced"))->isVisibleTo(&panel));
    QVERIFY(fast->isVisibleTo(&panel) && exact->isVisibleTo(&panel));
    QVERIFY(panel.findChild<QLabel*>(QStringLiteral("tradeoffSentence"))
                ->text()
                .contains(QStringLiteral("The presets fast and balanced are the same setting")));
    QTest::mouseClick(exact, Qt::LeftButton);
    QCOMPARE(document.request().models, std::vector<std::string>{"limit-angle"});
    QTest::keyClick(panel.plot(), Qt::Key_Left);  // along the front: not to the beaten point
    QTest::keyClick(panel.plot(), Qt::Key_Return);
    QCOMPARE(document.request().settings.integer("predict.directions"), 12);
    QVERIFY(panel.findChild<QLabel*>(QStringLiteral("tradeoffSentence"))
                ->text()
                .contains(QStringLiteral("for a test, within 12.5 µs a frame")));
  }

  void anEmptyPlotSaysWhatIsGoingOn() {
    Document document(parseTrainSpec);
    TradeoffPanel panel(document);
    QCOMPARE(panel.plot()->message(), QStringLiteral("No scene"));
    document.open(fixture_.opened());
    QVERIFY(panel.plot()->message().startsWith(QStringLiteral("Not measured yet")));
    QTest::mouseClick(panel.findChild<QPushButton*>(QStringLiteral("measureTradeoff")), Qt::LeftButton);
    panel.setBusy(true);
    QVERIFY(panel.plot()->message().startsWith(QStringLiteral("Measuring")));
    panel.setBusy(false);
    QVERIFY(panel.plot()->message().startsWith(QStringLiteral("Not measured yet")));
    document.setTradeoff(std::make_shared<const Tradeoff>(threePoints()));
    QCOMPARE(panel.plot()->message(), QString());
  }

  void theSessionKeepsIt() {
    const QTemporaryDir folder;
    Opened opened = fixture_.opened();
    opened.tradeoff = std::make_shared<const Tradeoff>(threePoints());
    const std::string file = folder.filePath(QStringLiteral("a.glint")).toStdString();
    saveSession(opened, nullptr, file);
    const Session again = readSession(file);
    QVERIFY(again.tradeoff);
    QCOMPARE(int(again.tradeoff->points.size()), 3);
    QCOMPARE(again.tradeoff->reason, std::string("for a test, within 12.5 us a frame"));
  }

  void measureAndAutoRunOffTheInterfaceThread() {
    Engine engine = fixture_.engine();
    engine.tradeoff = [](std::shared_ptr<const Scene>, const InspectionRequest&, const std::string&, const ProgressFn& progress) {
      if (!progress({"tradeoff", 0, 1})) throw Stopped{};
      return threePoints();
    };
    double asked = -1;
    engine.choose = [&](std::shared_ptr<const Scene>, const InspectionRequest&, std::optional<double> goodEnough,
                        const ProgressFn&, const Inspection*) {
      asked = goodEnough.value_or(0);
      glint::Selection s;
      s.model = s.best = "dual";
      s.why = "because";
      return s;
    };
    MainWindow window(engine);
    window.show();
    window.document().open(fixture_.opened());
    QTRY_VERIFY(window.idle() && !window.document().stale());
    QTest::mouseClick(window.findChild<QPushButton*>(QStringLiteral("measureTradeoff")), Qt::LeftButton);
    QTRY_VERIFY(window.document().tradeoff());
    QVERIFY(!window.document().stale());
    QTest::mouseClick(window.findChild<QPushButton*>(QStringLiteral("autoModel")), Qt::LeftButton);
    QTRY_COMPARE(window.document().request().models, std::vector<std::string>{"dual"});
    QCOMPARE(asked, 0.0);
    QCOMPARE(window.findChild<QLabel*>(QStringLiteral("choice"))->text(), QStringLiteral("because"));
    QTRY_VERIFY(window.idle() && !window.document().stale());
  }

 private:
  Fixture fixture_;
};

QObject* makeTradeoffTest() { return new TradeoffTest; }

}  // namespace glint::gui

#include "tradeoff_test.moc"
