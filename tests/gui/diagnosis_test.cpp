// SPDX-License-Identifier: BSD-3-Clause
// What is wrong and what helps, by clicks: a fault is put into exact contours, and the dock must lead out of it.
#include <QLabel>
#include <QMenu>
#include <QPushButton>
#include <QRegularExpression>
#include <QSet>
#include <QSignalSpy>
#include <QTreeWidget>

#include "gui/panels/diagnosis_panel.h"
#include "tests/core/inspect/exact_scene.h"
#include "tests/gui/fixture.h"

namespace glint::gui {

class DiagnosisTest : public QObject {
  Q_OBJECT
 private:
  /// The contour of frame 2 lies 12 px beside its place: its exclusion leaves exact contours.
  static std::shared_ptr<Scene> faulty() {
    using namespace testing_support;
    const std::shared_ptr<Scene> scene = exactScene(sphere(0.5), 9);
    Highlight& h = scene->frames[2].highlights[0];
    for (Pixel& p : h.contour.points) p.x() += 12;
    h.peak.x() += 12;
    return scene;
  }
  static void open(Document& document, std::shared_ptr<const Scene> scene) {
    Opened opened;
    opened.path = "exact.json";
    opened.scene = std::move(scene);
    opened.request.models = {"limit-angle"};
    opened.request.train = "0-5";
    document.open(opened);
    compute(document);
  }
  static void compute(Document& document) {
    const InspectionRequest request = document.request();
    document.setInspection(std::make_shared<const Inspection>(inspect(document.sharedScene(), request)), request);
  }
  static QStringList lines(const DiagnosisPanel& panel) {
    QStringList all;
    for (int i = 0; i < panel.list()->topLevelItemCount(); ++i) {
      const QTreeWidgetItem* top = panel.list()->topLevelItem(i);
      all << top->text(0);
      for (int j = 0; j < top->childCount(); ++j) all << top->child(j)->text(0);
    }
    return all;
  }
  static QPushButton* tryOf(const DiagnosisPanel& panel, const QString& flags) {
    for (QPushButton* b : panel.list()->findChildren<QPushButton*>(QStringLiteral("try")))
      if (b->accessibleName() == QStringLiteral("Try ") + flags) return b;
    return nullptr;
  }

 private slots:
  /// 5 of 25 highlights are missed, all of them cut by the border; the others are off by 1 %.
  void whatWrongHighlightsHaveInCommonIsOneClick() {
    const Fixture fixture(25);
    Document document(parseTrainSpec);
    DiagnosisPanel panel(document);
    panel.resize(600, 400);
    panel.show();
    QVERIFY(QTest::qWaitForWindowExposed(&panel));
    Opened opened = fixture.opened();
    opened.request.models = {"dual"};
    document.open(opened);
    auto inspection = std::make_shared<Inspection>(drawnCircles(fixture.scene(), document.request()));
    for (FrameComparison& c : inspection->models.at("dual").frames) {
      FrameComparison::Row& row = c.rows.front();
      if (!row.metrics) row.metrics.emplace(), c.prediction = inspection->models.at("dual").frames.front().prediction;
      row.failure.reset();
      row.metrics->contourErrorPct = 1;
      if (c.frame % 5 != 2) continue;
      inspection->evidence[std::size_t(c.frame)].highlights.front().touchesBorder = true;
      row.metrics.reset();
      row.predicted = -1;
    }
    document.setInspection(inspection, document.request());
    const QList<QTreeWidgetItem*> found =
        panel.list()->findItems(QStringLiteral("in common"), Qt::MatchStartsWith | Qt::MatchRecursive);
    QCOMPARE(found.size(), 1);
    QCOMPARE(found[0]->text(0), QStringLiteral("in common: 5 of 5 are cut by the image's border; 0 of 20 others"));
    QTest::mouseClick(panel.list()->viewport(), Qt::LeftButton, {}, panel.list()->visualItemRect(found[0]).center());
    QCOMPARE(int(document.brushed().size()), 5);
    QCOMPARE(document.brushed().begin()->frame, 2);
  }

  void aFaultIsNamedAndItsRemedyIsOneStepOfUndo() {
    Document document(parseTrainSpec);
    DiagnosisPanel panel(document);
    panel.resize(600, 400);
    panel.show();
    QVERIFY(QTest::qWaitForWindowExposed(&panel));
    open(document, faulty());
    auto* ask = panel.findChild<QPushButton*>(QStringLiteral("diagnose"));
    QVERIFY(ask->isEnabled());
    QTest::mouseClick(ask, Qt::LeftButton);
    QTRY_VERIFY(!panel.busy());
    QVERIFY2(!lines(panel).filter(QStringLiteral("against it: frame v2")).isEmpty(), qPrintable(lines(panel).join("\n")));
    // Causes, then what helps, then the evidence, and the list of wrong frames at the end.
    const QTreeWidgetItem* top = panel.list()->topLevelItem(0);
    QStringList kinds;
    for (int i = 0; i < top->childCount(); ++i) {
      const QString text = top->child(i)->text(0);
      const QString kind =
          panel.list()->itemWidget(top->child(i), 0) ? QStringLiteral("remedy") : text.section(QRegularExpression("[ :]"), 0, 0);
      if (kinds.isEmpty() || kinds.back() != kind) kinds << kind;
    }
    QCOMPARE(kinds, (QStringList{"because", "remedy", "against", "fit", "what"}));
    // A click on the highlight selects it.
    const QList<QTreeWidgetItem*> against =
        panel.list()->findItems(QStringLiteral("against it: frame v2"), Qt::MatchStartsWith | Qt::MatchRecursive);
    panel.list()->scrollToItem(against.at(0));
    QTest::mouseClick(panel.list()->viewport(), Qt::LeftButton, {}, panel.list()->visualItemRect(against.at(0)).center());
    QCOMPARE(document.selection().frame, 2);
    QCOMPARE(document.selection().light, std::string("lamp"));
    QCOMPARE(document.selection().model, std::string("limit-angle"));

    QPushButton* const remedy = tryOf(panel, QStringLiteral("--exclude v2"));
    QVERIFY(remedy);
    const InspectionRequest before = document.request();
    const int steps = document.undoStack()->index();
    remedy->click();
    QCOMPARE(document.request().excluded, std::vector<int>{2});
    QCOMPARE(document.undoStack()->index(), steps + 1);
    compute(document);
    QCOMPARE(panel.problems(), 0);
    QVERIFY2(
        lines(panel).value(0).startsWith(QStringLiteral("limit-angle: no problem found in 3 held-out frames, median error ")),
        qPrintable(lines(panel).join("\n")));
    document.undoStack()->undo();
    QVERIFY(document.request() == before);
  }

  /// The action (menu, palette, a script) does what a click on the first "Try" does, and says so where there is none.
  void theFirstRemedyIsAnAction() {
    Document document(parseTrainSpec);
    DiagnosisPanel panel(document);
    panel.resize(400, 160);
    panel.show();
    QVERIFY(QTest::qWaitForWindowExposed(&panel));
    Actions actions;
    QMenu menu;
    int shown = 0;
    panel.addActions(actions, &menu, [&] { ++shown; });
    open(document, faulty());
    QSignalSpy problem(&panel, &DiagnosisPanel::problem);
    actions.find("plots.try-remedy")->trigger();
    QCOMPARE(problem.size(), 1);
    actions.find("plots.diagnose")->trigger();
    QTRY_VERIFY(!panel.busy());
    QCOMPARE(shown, 2);
    const InspectionRequest before = document.request();
    const QTreeWidgetItem* top = panel.list()->topLevelItem(0);
    QPushButton* first = nullptr;
    for (int i = 0; i < top->childCount() && !first; ++i)
      if (QWidget* holder = panel.list()->itemWidget(top->child(i), 0))
        first = holder->findChild<QPushButton*>(QStringLiteral("try"));
    QVERIFY(first);
    // In sight, though the panel has room for few lines.
    QTRY_VERIFY(panel.list()->viewport()->rect().contains(first->geometry().translated(first->parentWidget()->pos())));
    first->click();
    const InspectionRequest clicked = document.request();
    QVERIFY(!(clicked == before));
    document.undoStack()->undo();
    actions.find("plots.try-remedy")->trigger();
    QVERIFY(document.request() == clicked);
  }

  /// Sentences are read without hovering, in the words of the window, and once each; an undo brings back what is known of that state.
  void whatItSaysCanBeRead() {
    Document document(parseTrainSpec);
    DiagnosisPanel panel(document);
    panel.resize(300, 400);
    panel.show();
    QVERIFY(QTest::qWaitForWindowExposed(&panel));
    open(document, faulty());
    panel.diagnose();
    QTRY_VERIFY(!panel.busy());
    const QList<QTreeWidgetItem*> against =
        panel.list()->findItems(QStringLiteral("against it: frame v2"), Qt::MatchStartsWith | Qt::MatchRecursive);
    QVERIFY(!against.isEmpty());
    const QRect row = panel.list()->visualItemRect(against.at(0));
    const QFontMetrics metrics(panel.list()->font());
    QVERIFY(metrics.horizontalAdvance(against.at(0)->text(0)) > row.width());  // it does not fit into one line
    QVERIFY2(row.height() >= 2 * metrics.lineSpacing(), qPrintable(QString::number(row.height())));
    QVERIFY(tryOf(panel, QStringLiteral("--exclude v2")));
    bool words = false;
    for (const QLabel* label : panel.list()->findChildren<QLabel*>())
      words = words || label->text().startsWith(QStringLiteral("leave out 2: error "));
    QVERIFY(words);
    const QStringList before = lines(panel);
    tryOf(panel, QStringLiteral("--exclude v2"))->click();
    QCOMPARE(document.undoStack()->undoText(), QStringLiteral("Try: leave out 2"));
    compute(document);
    const auto* state = panel.findChild<QLabel*>(QStringLiteral("diagnoseState"));
    QVERIFY2(state->text().contains(QStringLiteral("earlier state")), qPrintable(state->text()));
    QStringList said = lines(panel);
    said.removeAll(QString());
    QCOMPARE(QSet<QString>(said.begin(), said.end()).size(), said.size());
    document.undoStack()->undo();
    compute(document);
    QVERIFY2(!state->text().contains(QStringLiteral("earlier state")), qPrintable(state->text()));
    QCOMPARE(lines(panel), before);
  }

  void anotherModelIsAddedAndSelected() {
    Document document(parseTrainSpec);
    DiagnosisPanel panel(document);
    Opened opened;
    opened.path = "exact.json";
    opened.scene = testing_support::exactScene(testing_support::cylinder(0.3), 9);
    opened.request.models = {"primal"};  // cannot explain a cylinder
    opened.request.train = "0-5";
    document.open(opened);
    compute(document);
    QVERIFY(panel.problems() > 0);
    panel.diagnose();
    QTRY_VERIFY(!panel.busy());
    QPushButton* const remedy = tryOf(panel, QStringLiteral("--model limit-angle"));
    QVERIFY2(remedy, qPrintable(lines(panel).join("\n")));
    remedy->click();
    QCOMPARE(document.request().models, (std::vector<std::string>{"primal", "limit-angle"}));
    QCOMPARE(document.selection().model, std::string("limit-angle"));
    // The dock opens with the good news; what is wrong with the other model is folded below.
    compute(document);
    QVERIFY2(
        lines(panel).value(0).startsWith(QStringLiteral("limit-angle: no problem found in 3 held-out frames, median error ")),
        qPrintable(lines(panel).join("\n")));
    QVERIFY(panel.list()->topLevelItemCount() > 1);
    for (int i = 1; i < panel.list()->topLevelItemCount(); ++i) {
      QVERIFY(panel.list()->topLevelItem(i)->text(0).startsWith(QStringLiteral("primal")));
      QVERIFY(!panel.list()->topLevelItem(i)->isExpanded());
    }
    // Where the other one is selected, its faults come first, and can be read.
    document.select({0, "primal"});
    QVERIFY(panel.list()->topLevelItem(0)->text(0).startsWith(QStringLiteral("primal")));
    QVERIFY(panel.list()->topLevelItem(0)->isExpanded());
  }

  void withoutProblemsItSaysSoAndAsksNothing() {
    Document document(parseTrainSpec);
    DiagnosisPanel panel(document);
    QVERIFY(!panel.findChild<QPushButton*>(QStringLiteral("diagnose"))->isEnabled());
    QSignalSpy problems(&panel, &DiagnosisPanel::problemsChanged);
    open(document, testing_support::exactScene(testing_support::sphere(0.5), 9));
    QCOMPARE(panel.problems(), 0);
    QCOMPARE(problems.last().at(0).toInt(), 0);
    QCOMPARE(panel.list()->topLevelItemCount(), 0);
  }

  void aStopEndsItAndKeepsWhatWasFound() {
    Document document(parseTrainSpec);
    DiagnosisPanel panel(document);
    open(document, faulty());
    panel.diagnose();
    QVERIFY(panel.busy());
    panel.stop();
    QTRY_VERIFY(!panel.busy());
    QVERIFY(panel.findChild<QPushButton*>(QStringLiteral("diagnose"))->isEnabled());
  }
};

QObject* makeDiagnosisTest() { return new DiagnosisTest; }

}  // namespace glint::gui

#include "diagnosis_test.moc"
