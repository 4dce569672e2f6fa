// SPDX-License-Identifier: BSD-3-Clause
// What is wrong and what helps, by clicks: a fault is put into exact contours, and the dock must lead out of it.
#include <QLabel>
#include <QMenu>
#include <QProgressBar>
#include <QPushButton>
#include <QSet>
#include <QSignalSpy>
#include <QTreeWidget>

#include "gui/panels/diagnosis_panel.h"
#include "tests/core/pipeline/exact_scene.h"
#include "tests/gui/fixture.h"

namespace glint::gui {

class DiagnosisTest : public QObject {
  Q_OBJECT
 private:
  static constexpr int kLongest = 60'000;  // ms: fits of every model on a loaded machine
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
  /// The buttons that are listed now: those that a change of the list removed are deleted later.
  static QList<QPushButton*> tries(const DiagnosisPanel& panel) {
    QList<QPushButton*> all;
    const QTreeWidgetItem* const top = panel.list()->topLevelItem(0);
    for (int i = 0; top && i < top->childCount(); ++i)
      if (const QWidget* const holder = panel.list()->itemWidget(top->child(i), 0))
        all << holder->findChild<QPushButton*>(QStringLiteral("try"));
    return all;
  }
  static QPushButton* tryOf(const DiagnosisPanel& panel, const QString& flags) {
    for (QPushButton* b : tries(panel))
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

  /// A flash that was said to stand still: the list says so before anything is asked, and one click takes the statement back.
  void aLightThatIsSaidToStandStillAndMovesIsOneClick() {
    Document document(parseTrainSpec);
    DiagnosisPanel panel(document);
    panel.resize(600, 400);
    panel.show();
    QVERIFY(QTest::qWaitForWindowExposed(&panel));
    open(document, testing_support::flashLitScene(testing_support::sphere(0.5), 9));
    document.setSetting("light.frame", std::string("world"));
    compute(document);
    const QStringList said = lines(panel).filter(QStringLiteral("light.frame=world, but the lamp moves with the camera"));
    QVERIFY2(!said.isEmpty() && said.front().startsWith(QStringLiteral("because ")), qPrintable(lines(panel).join("\n")));
    QTest::mouseClick(panel.findChild<QPushButton*>(QStringLiteral("diagnose")), Qt::LeftButton);
    QTRY_VERIFY_WITH_TIMEOUT(!panel.busy(), kLongest);
    QVERIFY2(!tries(panel).isEmpty(), qPrintable(lines(panel).join("\n")));
    QPushButton* const remedy = tries(panel).front();
    QVERIFY2(remedy->accessibleName().endsWith(QStringLiteral("--set light.frame=auto")), qPrintable(remedy->accessibleName()));
    QTest::mouseClick(remedy, Qt::LeftButton);
    QCOMPARE(document.request().settings.text("light.frame"), std::string("auto"));
    document.undoStack()->undo();
    QCOMPARE(document.request().settings.text("light.frame"), std::string("world"));
  }

  /// The verdict and its remedies stand first, what they stand on is folded, and why models fail is below.
  void aVerdictItsRemediesAndBelowWhatTheyStandOn() {
    Document document(parseTrainSpec);
    DiagnosisPanel panel(document);
    panel.resize(600, 400);
    panel.show();
    QVERIFY(QTest::qWaitForWindowExposed(&panel));
    open(document, faulty());
    auto* ask = panel.findChild<QPushButton*>(QStringLiteral("diagnose"));
    QVERIFY(ask->isEnabled());
    QTest::mouseClick(ask, Qt::LeftButton);
    // At once: a word, a count and a way to stop.
    QVERIFY(!panel.findChild<QLabel*>(QStringLiteral("diagnoseState"))->text().isEmpty());
    QVERIFY(panel.findChild<QProgressBar*>(QStringLiteral("diagnoseProgress"))->isVisible());
    QCOMPARE(ask->text(), QStringLiteral("Stop"));
    QTRY_VERIFY_WITH_TIMEOUT(!panel.busy(), kLongest);
    const QTreeWidgetItem* top = panel.list()->topLevelItem(0);
    const int remedies = tries(panel).size();
    QVERIFY(remedies >= 1 && remedies <= 3);
    QVERIFY(top->font(0).bold());
    QVERIFY(top->isExpanded());
    QCOMPARE(top->childCount(), remedies + 1);
    const QTreeWidgetItem* stands = top->child(top->childCount() - 1);
    QVERIFY(!stands->isExpanded());
    QVERIFY(stands->childCount() > 1);
    QVERIFY(!panel.list()->topLevelItem(1)->isExpanded());
    // A click on the highlight that stands against the model selects it.
    const QList<QTreeWidgetItem*> against =
        panel.list()->findItems(QStringLiteral("against it: frame v2"), Qt::MatchStartsWith | Qt::MatchRecursive);
    QVERIFY2(!against.isEmpty(), qPrintable(lines(panel).join("\n")));
    against.at(0)->parent()->setExpanded(true);
    panel.list()->scrollToItem(against.at(0));
    QTest::mouseClick(panel.list()->viewport(), Qt::LeftButton, {}, panel.list()->visualItemRect(against.at(0)).center());
    QCOMPARE(document.selection().frame, 2);
    QCOMPARE(document.selection().light, std::string("lamp"));
    QCOMPARE(document.selection().model, std::string("limit-angle"));

    QPushButton* const remedy = tryOf(panel, QStringLiteral("--exclude v2"));
    QVERIFY2(remedy, qPrintable(lines(panel).join("\n")));
    QVERIFY(remedy->isEnabled());
    const InspectionRequest before = document.request();
    const int steps = document.undoStack()->index();
    panel.list()->scrollToTop();
    QTest::mouseClick(remedy, Qt::LeftButton);
    QCOMPARE(document.request().excluded, std::vector<int>{2});
    QCOMPARE(document.undoStack()->index(), steps + 1);
    QCOMPARE(document.undoStack()->undoText(), QStringLiteral("Try: leave out v2"));
    // The list is of the state before: until the new state is asked about, there is nothing to try.
    for (const QPushButton* const button : tries(panel)) QVERIFY(!button->isEnabled());
    compute(document);
    QCOMPARE(panel.problems(), 0);
    QVERIFY(tries(panel).isEmpty());
    const auto* state = panel.findChild<QLabel*>(QStringLiteral("diagnoseState"));
    QVERIFY2(state->text().contains(QStringLiteral("ask again")), qPrintable(state->text()));
    // An undo brings back what is known of that state.
    document.undoStack()->undo();
    QVERIFY(document.request() == before);
    compute(document);
    QVERIFY(tryOf(panel, QStringLiteral("--exclude v2")));
  }

  /// The action (menu, palette, a script) does what a click on the first "Try" does, and says so if there is no such button.
  void theFirstRemedyIsAnAction() {
    Document document(parseTrainSpec);
    DiagnosisPanel panel(document);
    panel.resize(400, 200);
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
    QTRY_VERIFY_WITH_TIMEOUT(!panel.busy(), kLongest);
    QCOMPARE(shown, 2);
    QPushButton* const first = tries(panel).value(0);
    QVERIFY(first);
    QTRY_VERIFY(
        panel.list()->viewport()->rect().contains(first->geometry().translated(first->parentWidget()->pos())));  // in sight
    const InspectionRequest before = document.request();
    first->click();
    const InspectionRequest clicked = document.request();
    QVERIFY(!(clicked == before));
    document.undoStack()->undo();
    compute(document);
    actions.find("plots.try-remedy")->trigger();
    QVERIFY(document.request() == clicked);
  }

  /// Where a better model is computed already, "Try" selects it; the verdict is then about that model, and offers nothing that is
  /// on screen.
  void anotherModelIsSelectedAndTheVerdictIsAboutIt() {
    Document document(parseTrainSpec);
    DiagnosisPanel panel(document);
    panel.resize(600, 400);
    panel.show();
    QVERIFY(QTest::qWaitForWindowExposed(&panel));
    Opened opened;
    opened.path = "exact.json";
    opened.scene = testing_support::exactScene(testing_support::cylinder(0.3), 9);
    opened.request.models = {"primal", "limit-angle"};  // the first one cannot explain a cylinder
    opened.request.train = "0-5";
    document.open(opened);
    compute(document);
    document.select({0, "primal"});
    panel.diagnose();
    QTRY_VERIFY_WITH_TIMEOUT(!panel.busy(), kLongest);
    QVERIFY2(lines(panel).value(0).startsWith(QStringLiteral("Use limit-angle: ")), qPrintable(lines(panel).join("\n")));
    QPushButton* const remedy = tryOf(panel, QStringLiteral("--model limit-angle"));
    QVERIFY2(remedy, qPrintable(lines(panel).join("\n")));
    const InspectionRequest before = document.request();
    remedy->click();
    QVERIFY(document.request() == before);
    QCOMPARE(document.selection().model, std::string("limit-angle"));
    QVERIFY2(lines(panel).value(0).startsWith(QStringLiteral("Nothing is left to improve: limit-angle is best")),
             qPrintable(lines(panel).join("\n")));
    QVERIFY(!tryOf(panel, QStringLiteral("--model limit-angle")));
    // A click on a line of the other model shows that model, without moving the line away.
    QTreeWidgetItem* const other = panel.list()->findItems(QStringLiteral("primal"), Qt::MatchStartsWith).value(0);
    QVERIFY(other);
    const int place = panel.list()->indexOfTopLevelItem(other);
    QTest::mouseClick(panel.list()->viewport(), Qt::LeftButton, {}, panel.list()->visualItemRect(other).center());
    QCOMPARE(document.selection().model, std::string("primal"));
    QCOMPARE(panel.list()->indexOfTopLevelItem(other), place);
    QVERIFY(lines(panel).value(0).startsWith(QStringLiteral("Use limit-angle: ")));
    QVERIFY(tryOf(panel, QStringLiteral("--model limit-angle"))->isEnabled());
  }

  /// A better model that was not computed is added.
  void anotherModelIsAdded() {
    Document document(parseTrainSpec);
    DiagnosisPanel panel(document);
    Opened opened;
    opened.path = "exact.json";
    opened.scene = testing_support::exactScene(testing_support::cylinder(0.3), 9);
    opened.request.models = {"primal"};
    opened.request.train = "0-5";
    document.open(opened);
    compute(document);
    QVERIFY(panel.problems() > 0);
    panel.diagnose();
    QTRY_VERIFY_WITH_TIMEOUT(!panel.busy(), kLongest);
    panel.tryFirst();
    QCOMPARE(document.request().models.size(), std::size_t(2));
    QCOMPARE(document.request().models.back(), document.selection().model);
    compute(document);
    QVERIFY2(lines(panel).value(0).contains(QStringLiteral(": no problem found in 3 held-out frames, median error ")),
             qPrintable(lines(panel).join("\n")));
  }

  /// Sentences are read without hovering, and once each.
  void whatItSaysCanBeRead() {
    Document document(parseTrainSpec);
    DiagnosisPanel panel(document);
    panel.resize(300, 400);
    panel.show();
    QVERIFY(QTest::qWaitForWindowExposed(&panel));
    open(document, faulty());
    panel.diagnose();
    QTRY_VERIFY_WITH_TIMEOUT(!panel.busy(), kLongest);
    const QTreeWidgetItem* const verdict = panel.list()->topLevelItem(0);
    const QRect row = panel.list()->visualItemRect(verdict);
    const QFontMetrics metrics(verdict->font(0));
    QVERIFY(metrics.horizontalAdvance(verdict->text(0)) > row.width());  // it does not fit into one line
    QVERIFY2(row.height() >= 2 * metrics.lineSpacing(), qPrintable(QString::number(row.height())));
    bool words = false;
    for (const QLabel* label : panel.list()->findChildren<QLabel*>())
      words = words || label->text().startsWith(QStringLiteral("leave out v2: error "));
    QVERIFY(words);
    QStringList said = lines(panel);
    said.removeAll(QString());
    QCOMPARE(QSet<QString>(said.begin(), said.end()).size(), said.size());
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

  /// From a change until its results are there: at every moment the list is of one state, whatever is asked for and selected
  /// meanwhile.
  void causesOfTwoStatesNeverStandBesideEachOther() {
    Document document(parseTrainSpec);
    DiagnosisPanel panel(document);
    panel.resize(600, 400);
    panel.show();
    QVERIFY(QTest::qWaitForWindowExposed(&panel));
    open(document, faulty());
    const auto linesOf = [](const std::shared_ptr<const Inspection>& inspection,
                            bool asked) {  // in a panel that saw nothing else
      Document other(parseTrainSpec);
      DiagnosisPanel alone(other);
      Opened opened;
      opened.path = "exact.json";
      opened.scene = inspection->given;
      opened.request = inspection->request;
      other.open(opened);
      other.setInspection(inspection, inspection->request);
      if (asked) {
        alone.diagnose();
        if (!QTest::qWaitFor([&] { return !alone.busy(); }, kLongest)) return QStringList();
      }
      return lines(alone);
    };
    const std::shared_ptr<const Inspection> before = document.inspection();
    panel.diagnose();
    QTRY_VERIFY_WITH_TIMEOUT(!panel.busy(), kLongest);
    const QStringList old = linesOf(before, true);
    QCOMPARE(lines(panel), old);
    InspectionRequest between = document.request(), after = document.request();
    between.excluded = {2};  // nothing is wrong then
    after.train = "1,3-7";
    document.setRequest(between, "between");
    QVERIFY(document.stale());
    QCOMPARE(lines(panel), old);
    const auto middle = std::make_shared<const Inspection>(inspect(document.sharedScene(), between));
    document.setRequest(after, "after");
    document.setFrameInspection(std::make_shared<const Inspection>(
                                    answer(document.sharedScene(), {after, Question::Part::Frame, document.selection().frame})),
                                document.selection().frame);
    QCOMPARE(lines(panel), old);
    document.select({3, "limit-angle"});
    QCOMPARE(lines(panel), old);
    document.setInspection(middle, between);  // of a run that was overtaken
    QVERIFY(document.stale());
    QCOMPARE(lines(panel), linesOf(middle, false));
    compute(document);
    QCOMPARE(lines(panel), linesOf(document.inspection(), false));
    QVERIFY(lines(panel) != old && lines(panel) != linesOf(middle, false));
  }

  void aStopIsAcknowledgedAtOnceAndKeepsWhatWasFound() {
    Document document(parseTrainSpec);
    DiagnosisPanel panel(document);
    panel.resize(600, 400);
    panel.show();
    QVERIFY(QTest::qWaitForWindowExposed(&panel));
    open(document, faulty());
    panel.diagnose();
    QTRY_VERIFY_WITH_TIMEOUT(panel.list()->topLevelItem(0)->font(0).bold(), kLongest);  // a verdict
    QVERIFY(panel.busy());
    auto* const ask = panel.findChild<QPushButton*>(QStringLiteral("diagnose"));
    QTest::mouseClick(ask, Qt::LeftButton);
    const auto* state = panel.findChild<QLabel*>(QStringLiteral("diagnoseState"));
    QVERIFY2(state->text().startsWith(QStringLiteral("Stop")), qPrintable(state->text()));
    QTRY_VERIFY_WITH_TIMEOUT(!panel.busy(), kLongest);
    QVERIFY2(state->text().startsWith(QStringLiteral("Stopped after ")), qPrintable(state->text()));
    QVERIFY(ask->isEnabled());
    QVERIFY(panel.list()->topLevelItem(0)->font(0).bold());
  }
};

QObject* makeDiagnosisTest() { return new DiagnosisTest; }

}  // namespace glint::gui

#include "diagnosis_test.moc"
