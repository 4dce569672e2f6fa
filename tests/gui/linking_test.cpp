// SPDX-License-Identifier: BSD-3-Clause
// One selection in timeline, table and frame view.
#include <QApplication>
#include <QClipboard>
#include <QLabel>
#include <QMenu>
#include <QSet>
#include <QSignalSpy>
#include <QTableView>
#include <QTextDocument>
#include <QTextDocumentFragment>
#include <QToolButton>
#include <QToolTip>

#include "gui/base/stale_badge.h"
#include "gui/base/text.h"
#include "gui/frame/frame_canvas.h"
#include "gui/frame/frame_panel.h"
#include "gui/panels/error_model.h"
#include "gui/panels/error_table.h"
#include "gui/panels/numbers_panel.h"
#include "gui/panels/selection_text.h"
#include "gui/plots/conditioning_panel.h"
#include "gui/plots/plots_panel.h"
#include "gui/scene/scene_panel.h"
#include "gui/scene/scene_tree.h"
#include "gui/timeline/timeline.h"
#include "tests/gui/fixture.h"

namespace glint::gui {

class LinkingTest : public QObject {
  Q_OBJECT
 private slots:
  void init() {
    document_ = std::make_unique<Document>(parseTrainSpec);
    timeline_ = std::make_unique<Timeline>(*document_);
    table_ = std::make_unique<ErrorTable>(*document_);
    frame_ = std::make_unique<FramePanel>(*document_);
    document_->open(fixture_.opened());
    document_->setInspection(std::make_shared<const Inspection>(drawnCircles(fixture_.scene(), document_->request())),
                             document_->request());
    timeline_->resize(900, 90);
    timeline_->show();
    table_->resize(1000, 400);
    table_->show();
    frame_->resize(500, 500);
    frame_->show();
    QVERIFY(QTest::qWaitForWindowExposed(timeline_.get()));
    QVERIFY(QTest::qWaitForWindowExposed(table_.get()));
  }
  void cleanup() {
    frame_.reset();
    table_.reset();
    timeline_.reset();
  }

  void aClickInTheTimelineSelectsEverywhere() {
    TimelineStrip* strip = timeline_->strip();
    QTest::mouseClick(strip, Qt::LeftButton, {}, strip->cell(7).center().toPoint());
    QCOMPARE(document_->selection().frame, 7);
    QTRY_VERIFY(title().contains("0007"));  // with the numbers
    QVERIFY(title().contains("held out"));
    QCOMPARE(table_->view()->currentIndex().siblingAtColumn(ErrorModel::Frame).data().toString(), QStringLiteral("0007"));
    QSignalSpy loaded(frame_->loader(), &PhotoLoader::loaded);
    QTRY_VERIFY(!frame_->busy());
    // Frame 7's photograph has red 45 (fixture): what is on screen is this frame's.
    const QImage shown = frame_->canvas()->grab().toImage();
    QCOMPARE(qRed(shown.pixel(shown.width() / 2, shown.height() / 2 + shown.height() / 5)), 45);
  }

  void aRowOfTheTableSelectsEverywhere() {
    QTableView* view = table_->view();
    view->sortByColumn(ErrorModel::ErrorPct, Qt::DescendingOrder);
    // Failures have no number and come first in descending order; the first number is the largest error.
    int row = 0;
    while (view->model()->index(row, ErrorModel::Status).data().toString() == QStringLiteral("refused")) ++row;
    const QModelIndex worst = view->model()->index(row, ErrorModel::Frame);
    for (int r = row + 1; r < view->model()->rowCount(); ++r)
      QVERIFY(view->model()->index(r, ErrorModel::ErrorPct).data(ErrorModel::kSortRole).toDouble() <=
              view->model()->index(row, ErrorModel::ErrorPct).data(ErrorModel::kSortRole).toDouble());
    view->scrollTo(worst);
    QTest::mouseClick(view->viewport(), Qt::LeftButton, {}, view->visualRect(worst).center());
    QCOMPARE(toQString(fixture_.scene()->frames[std::size_t(document_->selection().frame)].id), worst.data().toString());
    QCOMPARE(toQString(document_->selection().model), worst.siblingAtColumn(ErrorModel::Model).data().toString());
    QTRY_VERIFY(title().contains(worst.data().toString()));
    QCOMPARE(document_->undoStack()->count(), 1);
  }

  void keysStepAndChangeRoles() {
    TimelineStrip* strip = timeline_->strip();
    strip->setFocus();
    QTest::keyClick(strip, Qt::Key_Right);
    QTest::keyClick(strip, Qt::Key_Right);
    QTest::keyClick(strip, Qt::Key_Left);
    QCOMPARE(document_->selection().frame, 1);
    QTest::keyClick(strip, Qt::Key_End);
    QCOMPARE(document_->selection().frame, 11);
    QTest::keyClick(strip, Qt::Key_Right);  // there is no next one
    QCOMPARE(document_->selection().frame, 11);
    QTest::keyClick(strip, Qt::Key_X);
    QCOMPARE(document_->request().excluded, std::vector<int>{11});
    QVERIFY(title().contains("excluded"));
    document_->undoStack()->undo();
    QVERIFY(document_->request().excluded.empty());
    QVERIFY(title().contains("held out"));
  }

  /// A key that is held down is one intention.
  void aRunOfStepsIsOneStepOfUndo() {
    TimelineStrip* strip = timeline_->strip();
    strip->setFocus();
    for (int i = 0; i < 3; ++i) QTest::keyClick(strip, Qt::Key_Right);
    QCOMPARE(document_->undoStack()->count(), 1);
    QTest::qWait(700);  // the next one is another
    QTest::keyClick(strip, Qt::Key_Right);
    QCOMPARE(document_->undoStack()->count(), 2);
    document_->undoStack()->undo();
    QCOMPARE(document_->selection().frame, 3);
    document_->undoStack()->undo();
    QCOMPARE(document_->selection().frame, 0);
  }

  void aRunOfRowsIsOneStepOfUndo() {
    QTableView* view = table_->view();
    view->setFocus();
    view->selectionModel()->setCurrentIndex(view->model()->index(0, 0),
                                            QItemSelectionModel::ClearAndSelect | QItemSelectionModel::Rows);
    const draw::Selection first = document_->selection();
    QTest::qWait(700);  // longer than a run's gap
    const int before = document_->undoStack()->count();
    for (int i = 0; i < 5; ++i) QTest::keyClick(view, Qt::Key_Down);
    QVERIFY(document_->selection() != first);
    QCOMPARE(document_->undoStack()->count(), before + 1);
    document_->undoStack()->undo();
    QVERIFY(document_->selection() == first);
  }

  void playingIsNoStepOfUndo() {
    timeline_->setPlaying(true);
    QTRY_VERIFY(document_->selection().frame >= 3);
    timeline_->setPlaying(false);
    QCOMPARE(document_->undoStack()->count(), 0);
  }

  void everyRowHasANumberOrAReason() {
    const QAbstractItemModel* model = table_->view()->model();
    QCOMPARE(model->rowCount(), 12 * 5);
    for (int r = 0; r < model->rowCount(); ++r) {
      const bool number = model->index(r, ErrorModel::ErrorPct).data().toString() != QStringLiteral("–");
      const QString reason = model->index(r, ErrorModel::ReasonText).data().toString();
      QVERIFY2(number != !reason.isEmpty(), qPrintable(QStringLiteral("row %1: '%2'").arg(r).arg(reason)));
    }
  }

  /// While a slider moves, numbers change and their columns stay in place; an error far beyond the highlight's size is shown as
  /// such.
  void theSummarysColumnsStayWhereTheyAre() {
    auto* summary = table_->findChild<QLabel*>(QStringLiteral("errorSummary"));
    QSet<int> widths;
    for (const double factor : {0.001, 1.0, 20.0, 12345.6}) {
      Inspection inspection = drawnCircles(fixture_.scene(), document_->request());
      for (auto& [name, model] : inspection.models)
        for (FrameComparison& c : model.frames)
          for (FrameComparison::Row& r : c.rows)
            if (r.metrics) r.metrics->contourErrorPct *= factor;
      document_->setInspection(std::make_shared<const Inspection>(inspection), document_->request());
      widths << summary->sizeHint().width();
      QCOMPARE(summary->text().contains(QStringLiteral("&gt; 1000")), factor > 1000);
      const QString error = table_->view()->model()->index(0, ErrorModel::ErrorPct).data().toString();
      QVERIFY2(error.size() <= 7, qPrintable(error));
    }
    QCOMPARE(widths.size(), 1);
  }

  /// Two highlights of one light in a frame are two rows that can be told apart.
  void rowsOfTwoHighlightsNameThem() {
    Inspection inspection = drawnCircles(fixture_.scene(), document_->request());
    for (auto& [name, model] : inspection.models) {
      FrameComparison::Row second = model.frames.front().rows.front();
      second.observed = 1;
      model.frames.front().rows.push_back(second);
    }
    document_->setInspection(std::make_shared<const Inspection>(inspection), document_->request());
    const QAbstractItemModel* rows = table_->view()->model();
    QSet<QString> first;
    for (int r = 0; r < rows->rowCount(); ++r) {
      const QString light = rows->index(r, ErrorModel::Light).data().toString();
      if (rows->index(r, ErrorModel::Frame).data().toString() == QStringLiteral("0000"))
        first << light;
      else
        QCOMPARE(light, QStringLiteral("lamp"));
    }
    QCOMPARE(first, (QSet<QString>{QStringLiteral("lamp, highlight 1"), QStringLiteral("lamp, highlight 2")}));
  }

  void undoSelectsOneRow() {
    document_->selectFrame(3);
    document_->selectFrame(5);
    document_->undoStack()->undo();
    QCOMPARE(table_->view()->selectionModel()->selectedRows().size(), 1);
  }

  void rowsAreCopiedAsTabSeparatedText() {
    QTableView* view = table_->view();
    view->selectRow(0);
    view->setFocus();
    QTest::keyClick(view, Qt::Key_C, Qt::ControlModifier);
    const QStringList lines = QApplication::clipboard()->text().split('\n');
    QCOMPARE(lines.size(), 3);  // header, row, end
    QVERIFY(lines[0].startsWith(QStringLiteral("Frame\tRole\tModel")));
    QCOMPARE(lines[1].split('\t').size(), lines[0].split('\t').size());
    QCOMPARE(lines[1].section('\t', 0, 0), QStringLiteral("0000"));
  }

  void aClickOnTheHighlightSelectsItAndTheLegendHidesIt() {
    QTRY_VERIFY(!frame_->busy());
    FrameCanvas* canvas = frame_->canvas();
    canvas->fit();
    QTest::mouseClick(canvas, Qt::LeftButton, {}, canvas->widgetFromPixel(Fixture::centre(0)).toPoint());
    QCOMPARE(document_->selection().highlight, 0);
    QTest::mouseClick(canvas, Qt::LeftButton, {}, canvas->widgetFromPixel({150, 110}).toPoint());
    QCOMPARE(document_->selection().highlight, -1);
    const QImage with = canvas->grab().toImage();
    auto* toggle = frame_->findChild<QToolButton*>(QStringLiteral("frame/predicted"));
    QVERIFY(toggle && toggle->isChecked());
    QTest::mouseClick(toggle, Qt::LeftButton);
    QVERIFY(!document_->layerVisible("frame/predicted"));
    QVERIFY(canvas->grab().toImage() != with);
    document_->undoStack()->undo();
    QVERIFY(toggle->isChecked());
    QVERIFY(canvas->grab().toImage() == with);
  }

  void aNarrowSummaryLeavesColumnsOutInsteadOfCuttingThem() {
    auto* summary = table_->findChild<QLabel*>(QStringLiteral("errorSummary"));
    table_->resize(900, 300);
    QVERIFY(summary->text().contains("spurious") && summary->toolTip().isEmpty());
    for (const int width : {460, 380, 300}) {
      table_->resize(width, 300);
      QVERIFY2(!summary->text().contains(">predicted<") && summary->text().contains("mean"), qPrintable(summary->text()));
      QVERIFY(summary->toolTip().contains("spurious"));
      QVERIFY2(summary->sizeHint().width() <= width, qPrintable(QString::number(summary->sizeHint().width())));
    }
    table_->resize(900, 300);
    QVERIFY(summary->text().contains("spurious"));
  }

  /// Errors are those of matched highlights: a mean over few of them needs the number of missed ones beside it.
  void whatIsMissedIsSaidBeforeTheTailsOfTheErrors() {
    auto* summary = table_->findChild<QLabel*>(QStringLiteral("errorSummary"));  // the last frame's is missed by every model
    bool left = false;
    for (int width = 900; width >= 300; width -= 20) {
      table_->resize(width, 300);
      QVERIFY2(!summary->text().contains("p95") || summary->text().contains("missed"), qPrintable(summary->text()));
      left = left || (summary->text().contains("missed") && !summary->text().contains("p95"));
    }
    QVERIFY(left);
    table_->resize(900, 300);
  }

  /// What the command line warns of stands in the window, too: beside the errors, and with the numbers of the fit.
  void warningsOfFitsAreShown() {
    auto* button = table_->findChild<QToolButton*>(QStringLiteral("errorWarnings"));
    QVERIFY(button && button->isHidden());
    auto inspection = std::make_shared<Inspection>(*document_->inspection());
    ModelFit fit;
    fit.model = document_->plottedModel();
    fit.light = "lamp";
    fit.remarks = {"the fit explains <b>its</b> views poorly"};
    inspection->models[fit.model].fits = {{"lamp", {}, fit, {}}};
    document_->setInspection(inspection, document_->request());
    QVERIFY(!button->isHidden());
    QCOMPARE(button->text(), QStringLiteral("1 warning"));
    QVERIFY2(button->toolTip().contains("light lamp: the fit explains &lt;b&gt;its&lt;/b&gt; views poorly"),
             qPrintable(button->toolTip()));
    QTest::mouseClick(button, Qt::LeftButton);
    auto* menu = button->findChild<QMenu*>();
    QTRY_VERIFY(menu->isVisible());
    QCOMPARE(menu->findChild<QLabel*>(QStringLiteral("warningTexts"))->text(), button->toolTip());
    menu->close();
    // The label of tool tips takes the paragraphs for what they are.
    QToolTip::showText(button->mapToGlobal(QPoint()), button->toolTip(), button);
    const QLabel* tip = nullptr;
    for (const QWidget* widget : QApplication::topLevelWidgets())
      if (widget->inherits("QTipLabel") && widget->isVisible()) tip = qobject_cast<const QLabel*>(widget);
    QVERIFY(tip && tip->textFormat() != Qt::PlainText && Qt::mightBeRichText(tip->text()));
    QToolTip::hideText();
    QString numbers;
    draw::Selection selection;
    selection.model = fit.model;
    for (const NumberGroup& group : describeSelection(*inspection, selection, fit.model)) numbers += group.lines;
    QVERIFY2(numbers.contains("Warning: the fit explains <b>its</b> views poorly"), qPrintable(numbers));
  }

  /// The square before the name of a poor model looks as in plots and photographs.
  void aPoorModelsSquareIsPale() {
    auto* summary = table_->findChild<QLabel*>(QStringLiteral("errorSummary"));
    auto inspection = std::make_shared<Inspection>(*document_->inspection());
    const std::string model = document_->plottedModel();
    const QString strong = toQColor(draw::modelColour(model)).name(),
                  pale = toQColor(draw::pale(draw::modelColour(model))).name();
    QVERIFY2(summary->text().contains(strong) && !summary->text().contains(pale), qPrintable(summary->text()));
    ModelFit fit;
    fit.model = model;
    fit.light = "lamp";
    fit.poor = "a fifth of the radius remains";
    inspection->models[model].fits = {{"lamp", {}, fit, {}}};
    document_->setInspection(inspection, document_->request());
    QVERIFY2(summary->text().contains(pale) && !summary->text().contains(strong), qPrintable(summary->text()));
  }

  void staleResultsAreMarked() {
    auto* summary = table_->findChild<QLabel*>(QStringLiteral("errorSummary"));
    const auto* badge = table_->findChild<StaleBadge*>();
    QVERIFY(summary && badge && badge->isHidden());
    const int width = summary->sizeHint().width();
    const QString text = summary->text();
    const QVariant colour = table_->view()->model()->index(0, 0).data(Qt::ForegroundRole);
    document_->setSetting("detect.level", 0.3);
    QTRY_VERIFY(badge->isVisible());
    QVERIFY(badge->text().contains(QString::fromUtf8("updating")));
    QVERIFY(summary->text() != text);  // faded
    QCOMPARE(QTextDocumentFragment::fromHtml(summary->text()).toPlainText(), QTextDocumentFragment::fromHtml(text).toPlainText());
    QCOMPARE(summary->sizeHint().width(), width);  // no column jumps
    QVERIFY(table_->view()->model()->index(0, 0).data(Qt::ForegroundRole) != colour);
    document_->undoStack()->undo();
    QVERIFY(badge->isHidden());
    QCOMPARE(summary->text(), text);
    QCOMPARE(table_->view()->model()->index(0, 0).data(Qt::ForegroundRole), colour);
  }

  /// After a move of a slider the new contour is there before its prediction. The errors stay those of the last results, and are
  /// marked as such; no error mixes both.
  void anOldPredictionIsNotScoredAgainstANewContour() {
    frame_->resize(700, 700);
    const auto* captions = frame_->findChild<QLabel*>(QStringLiteral("frameCaptions"));
    const auto* badge = frame_->canvas()->findChild<StaleBadge*>();
    QTRY_VERIFY(captions->text().contains(QStringLiteral("this frame")));
    const auto words = [captions] { return QTextDocumentFragment::fromHtml(captions->text()).toPlainText(); };
    const QString before = words();
    QVERIFY2(before.contains(QStringLiteral("8.00")), qPrintable(before));  // the first model's error in the fixture
    document_->setSetting("detect.level", 0.3);
    Observation seen;
    seen.scene = seen.given = document_->sharedScene();
    seen.request = document_->request();
    seen.frame = 0;
    seen.evidence = drawnCircles(document_->sharedScene(), seen.request).evidence[0];
    for (Pixel& p : seen.evidence.highlights[0].contour.points) p = Fixture::centre(0) + 1.5 * (p - Fixture::centre(0));
    seen.inputs.evidence = evidenceInputs(seen.request, false);
    document_->setObservation(std::make_shared<const Observation>(seen));
    QTRY_VERIFY(badge->isVisible());
    QTRY_VERIFY(captions->text().contains(QStringLiteral("earlier state")));
    QCOMPARE(words().replace(QStringLiteral("earlier state"), QStringLiteral("this frame")), before);
    const auto shown = document_->frameInspection();
    QVERIFY(shown != document_->results());
    for (const auto& [name, model] : shown->models)
      for (const FrameComparison& c : model.frames) QVERIFY2(c.rows.empty(), name.c_str());
    // Their drawing is pale, and says so.
    draw::OverlayOptions options;
    options.predictionsEarlier = true;
    QString label;
    for (const draw::OverlayLine& line : draw::frameOverlay(*shown, 0, options).lines)
      if (line.role == draw::OverlayRole::PredictedContour) label = toQString(line.label);
    QVERIFY2(label.contains(QStringLiteral("updating")), qPrintable(label));
    document_->setInspection(std::make_shared<const Inspection>(drawnCircles(document_->sharedScene(), document_->request())),
                             document_->request());
    QTRY_COMPARE(words(), before);
    QVERIFY(badge->isHidden());
  }

  void everyPanelOfNumbersSaysThatItIsStale() {
    ScenePanel scene(*document_);
    PlotsPanel plots(*document_);
    ConditioningPanel conditioning(*document_);
    NumbersPanel numbers(*document_);
    SceneTree tree(*document_);
    const std::vector<StaleBadge*> badges{scene.findChild<StaleBadge*>(),   plots.findChild<StaleBadge*>(),
                                          table_->findChild<StaleBadge*>(), timeline_->findChild<StaleBadge*>(),
                                          tree.findChild<StaleBadge*>(),    conditioning.findChild<StaleBadge*>(),
                                          numbers.findChild<StaleBadge*>(), frame_->canvas()->findChild<StaleBadge*>()};
    for (const StaleBadge* badge : badges) QVERIFY(badge && badge->isHidden());
    document_->setSetting("detect.level", 0.35);
    for (const StaleBadge* badge : badges) QVERIFY(badge->isHidden());  // results may come before it would flicker
    for (const StaleBadge* badge : badges) QTRY_VERIFY(!badge->isHidden());
    document_->setInspection(std::make_shared<Inspection>(drawnCircles(document_->sharedScene(), document_->request())),
                             document_->request());
    for (const StaleBadge* badge : badges) QVERIFY(badge->isHidden());
  }

 private:
  QString title() const {
    return frame_->findChild<QLabel*>(QStringLiteral("frameTitle"))->text() + ' ' +
           frame_->findChild<QLabel*>(QStringLiteral("frameRole"))->text();
  }

  Fixture fixture_;
  std::unique_ptr<Document> document_;
  std::unique_ptr<Timeline> timeline_;
  std::unique_ptr<ErrorTable> table_;
  std::unique_ptr<FramePanel> frame_;
};

QObject* makeLinkingTest() { return new LinkingTest; }

}  // namespace glint::gui

#include "linking_test.moc"
