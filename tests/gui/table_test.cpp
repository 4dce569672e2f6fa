// SPDX-License-Identifier: BSD-3-Clause
// The table of errors and the scatter plot: what is shown, found, copied, brushed; two states side by side.
#include <QAction>
#include <QApplication>
#include <QClipboard>
#include <QComboBox>
#include <QDockWidget>
#include <QHeaderView>
#include <QLabel>
#include <QLineEdit>
#include <QMenu>
#include <QScrollBar>
#include <QSettings>
#include <QTableView>

#include "gui/base/text.h"
#include "gui/panels/error_columns.h"
#include "gui/panels/error_model.h"
#include "gui/panels/error_table.h"
#include "gui/panels/pinned_summary.h"
#include "gui/plots/plot_canvas.h"
#include "gui/plots/plots_panel.h"
#include "gui/plots/scatter_bar.h"
#include "gui/window/main_window.h"
#include "tests/gui/fixture.h"

namespace glint::gui {

class TableTest : public QObject {
  Q_OBJECT
 private slots:
  void init() {
    QSettings().remove(QStringLiteral("errors"));
    document_ = std::make_unique<Document>(parseTrainSpec);
    table_ = std::make_unique<ErrorTable>(*document_);
    document_->open(fixture_.opened());
    compute();
    table_->resize(1200, 400);
    table_->show();
    QVERIFY(QTest::qWaitForWindowExposed(table_.get()));
  }
  void cleanup() { table_.reset(); }

  /// 12 frames and 5 models. Training: 0 to 5. The last frame has no prediction, and no model a fit: refused.
  void rowsAreChosenByFrameModelStatusAndWords() {
    QCOMPARE(count(), QStringLiteral("60 rows"));
    choose("errorModelFilter", QStringLiteral("dual"));
    QCOMPARE(rows(), 12);
    choose("errorFilter", QStringLiteral("held-out frames"));
    QCOMPARE(rows(), 6);
    QCOMPARE(count(), QStringLiteral("6 of 60 rows"));
    choose("errorStatusFilter", QStringLiteral("refused"));
    QCOMPARE(rows(), 1);
    QCOMPARE(cell(0, ErrorModel::Frame), QStringLiteral("0011"));
    choose("errorModelFilter", QStringLiteral("all models"));
    choose("errorFilter", QStringLiteral("all frames"));
    QCOMPARE(rows(), 5);
    choose("errorStatusFilter", QStringLiteral("any status"));
    // Errors of the second model are 4 to 5.2 %: 4 + 0.1 ((5 i) mod 12).
    choose("errorModelFilter", QStringLiteral("dual"));
    choose("errorStatusFilter", QStringLiteral("far off"));
    for (int r = 0; r < rows(); ++r) QVERIFY(cell(r, ErrorModel::ErrorPct).toDouble() > 5);
    choose("errorStatusFilter", QStringLiteral("ok"));
    for (int r = 0; r < rows(); ++r) QVERIFY(cell(r, ErrorModel::ErrorPct).toDouble() <= 5);
    choose("errorStatusFilter", QStringLiteral("any status"));
    choose("errorModelFilter", QStringLiteral("all models"));
    auto* search = table_->findChild<QLineEdit*>(QStringLiteral("errorSearch"));
    search->setFocus();
    QTest::keyClicks(search, QStringLiteral("PRIMAL 0003"));
    QCOMPARE(rows(), 1);
    QCOMPARE(cell(0, ErrorModel::Model), QStringLiteral("primal"));
    QTest::keyClick(search, Qt::Key_Escape);
    QVERIFY(search->text().isEmpty());
    QCOMPARE(rows(), 60);
    QTest::keyClicks(search, QStringLiteral("not visible"));  // a reason
    QCOMPARE(rows(), 5);
    QTest::keyClicks(search, QStringLiteral(" nowhere"));
    QCOMPARE(rows(), 0);
    QCOMPARE(count(), QStringLiteral("0 of 60 rows"));
  }

  void aChosenModelStaysWhileResultsChange() {
    choose("errorModelFilter", QStringLiteral("dual"));
    InspectionRequest request = document_->request();
    request.models = {"dual", "canonical"};
    document_->setRequest(request, QStringLiteral("Models"));
    compute();
    QCOMPARE(table_->findChild<QComboBox*>(QStringLiteral("errorModelFilter"))->currentText(), QStringLiteral("dual"));
    QCOMPARE(rows(), 12);
    request.models = {"canonical"};
    document_->setRequest(request, QStringLiteral("Models"));
    compute();
    QCOMPARE(rows(), 12);  // all that there are
  }

  void columnsAreChosenAndKept() {
    ErrorColumns* columns = table_->columns();
    QVERIFY(columns->shown(ErrorModel::Iou) && !table_->view()->isColumnHidden(ErrorModel::Iou));
    QVERIFY(!columns->shown(ErrorModel::Pinned));
    columns->setShown(ErrorModel::Iou, false);
    QVERIFY(table_->view()->isColumnHidden(ErrorModel::Iou));
    const ErrorTable other(*document_);
    QVERIFY(!other.columns()->shown(ErrorModel::Iou) && other.columns()->shown(ErrorModel::PeakOffset));
    for (int c = 0; c < ErrorModel::ColumnCount; ++c) {
      const QAbstractItemModel* model = table_->view()->model();
      QVERIFY(!model->headerData(c, Qt::Horizontal).toString().isEmpty());
      QVERIFY(model->headerData(c, Qt::Horizontal, Qt::ToolTipRole).toString().size() > 5);
    }
    auto* menu = columns->menu();
    emit menu->aboutToShow();
    QCOMPARE(menu->actions().size(), int(ErrorModel::ColumnCount) - 3 + 3);  // without frame and pinned ones; a line and two more
    menu->actions().last()->trigger();
    QVERIFY(columns->shown(ErrorModel::Iou));
  }

  void rowsAreCopiedAsTheyAreShown() {
    table_->columns()->setShown(ErrorModel::Role, false);
    table_->view()->selectRow(0);
    table_->copySelection(QLatin1Char(','));
    const QStringList lines = QApplication::clipboard()->text().split('\n');
    QVERIFY2(lines[0].startsWith(QStringLiteral("Frame,Model,Error %,Error px")), qPrintable(lines[0]));
    QVERIFY(lines[1].startsWith(QStringLiteral("0000,primal,8.000,3.200,")));
    QCOMPARE(lines[1].count(','), lines[0].count(','));
  }

  void sortingShowsTheFirstRows() {
    table_->view()->scrollToBottom();
    QVERIFY(table_->view()->verticalScrollBar()->value() > 0);
    table_->view()->sortByColumn(ErrorModel::ErrorPct, Qt::DescendingOrder);
    QCOMPARE(table_->view()->verticalScrollBar()->value(), 0);
  }

  /// An arrow in a column's heading shows by which column and in which direction rows are sorted, also for right-aligned numbers.
  void sortingShowsItsArrow() {
    QHeaderView* const head = table_->view()->horizontalHeader();
    for (const int column : {int(ErrorModel::ErrorPct), int(ErrorModel::Model), int(ErrorModel::Status)}) {
      const QRect section(head->sectionViewportPosition(column), 0, head->sectionSize(column), head->height());
      const auto clicked = [&] {
        QTest::mouseClick(head->viewport(), Qt::LeftButton, {}, section.center());
        return head->viewport()->grab(section).toImage();
      };
      const QImage one = clicked(), other = clicked();
      QVERIFY(head->isSortIndicatorShown());
      QCOMPARE(head->sortIndicatorSection(), column);
      QVERIFY2(one != other, "the arrow points the other way");
    }
  }

  void sortingAgainstAColumnPutsWhatHasNoValueLast() {
    choose("errorModelFilter", QStringLiteral("dual"));
    table_->view()->sortByColumn(ErrorModel::ErrorPct, Qt::AscendingOrder);
    QCOMPARE(cell(11, ErrorModel::Frame), QStringLiteral("0011"));
    for (int r = 1; r < 11; ++r)
      QVERIFY(cell(r - 1, ErrorModel::ErrorPct).toDouble() <= cell(r, ErrorModel::ErrorPct).toDouble());
  }

  /// Two columns against each other; a rectangle chooses what the table shows.
  void aRectangleBrushesAndTheTableShowsIt() {
    PlotsPanel panel(*document_);
    panel.resize(1000, 360);
    panel.show();
    QVERIFY(QTest::qWaitForWindowExposed(&panel));
    document_->setOption("plots/two", "off", QStringLiteral("One plot"));
    document_->setOption("plots/first", "scatter", QStringLiteral("Plot"));
    QVERIFY(panel.scatterBar(0)->isVisible());
    auto* box = panel.scatterBar(0)->findChild<QComboBox*>(QStringLiteral("scatter-x"));
    const int column = box->findData(QStringLiteral("observed-px"));
    box->setCurrentIndex(column);
    emit box->activated(column);
    QCOMPARE(document_->option("plots/scatter-x", std::string()), std::string("observed-px"));
    panel.renderNow();
    PlotCanvas* canvas = panel.canvas(0);
    QCOMPARE(canvas->plot().remarks, (std::vector<std::string>{"55 of 60 highlights", "no value: 5 refused"}));
    // A click selects; the dots of one frame and model.
    const auto dot = canvas->positionOf({0, 4});
    QVERIFY(dot);
    const draw::PlotTarget target = canvas->plot().series[0].points[4].target;
    QTest::mouseClick(canvas, Qt::LeftButton, {}, dot->toPoint());
    QCOMPARE(document_->selection().model, target.model);
    QCOMPARE(document_->selection().frame, target.frame);
    const int steps = document_->undoStack()->count();
    // primal's errors are 8 % and more, all others' less than 6: a rectangle over the upper part holds primal alone.
    panel.renderNow();
    double lowest = 0;
    for (int i = 0; i < 11; ++i) lowest = std::max(lowest, canvas->positionOf({0, i})->y());
    drag(canvas, {QPoint(60, 30), QPoint(400, 100), QPoint(canvas->width() - 4, int(lowest) + 2)});
    QCOMPARE(int(document_->brushed().size()), 11);
    QCOMPARE(rows(), 11);
    for (int r = 0; r < rows(); ++r) QCOMPARE(cell(r, ErrorModel::Model), QStringLiteral("primal"));
    QCOMPARE(document_->undoStack()->count(), steps);  // no step of undo
    panel.renderNow();
    QCOMPARE(canvas->plot().series[0].name, std::string("not brushed"));
    QCOMPARE(int(canvas->plot().series[0].points.size()), 44);
    // A click beside all dots ends it, and the table shows what it showed.
    QTest::mouseClick(canvas, Qt::LeftButton, {}, QPoint(canvas->width() / 2 + 200, canvas->height() / 2));
    QVERIFY(document_->brushed().empty());
    QCOMPARE(rows(), 60);
    document_->setOption("plots/two", "on", QStringLiteral("Two plots"));
  }

  /// Errors double: every held-out highlight is worse, and the words say how many.
  void pinnedResultsAreComparedRowByRow() {
    QVERIFY(document_->pin());
    auto* summary = table_->findChild<QWidget*>(QStringLiteral("pinnedSummary"));
    const auto said = [&](const char* name) { return summary->findChild<QLabel*>(QLatin1String(name))->text(); };
    QVERIFY(summary->isVisible() && !table_->columns()->shown(ErrorModel::Pinned));
    const int steps = document_->undoStack()->count();
    document_->setSetting("detect.level", 0.4);
    compute(2);
    QCOMPARE(document_->undoStack()->count(), steps + 1);  // pinning is not a step
    QVERIFY(table_->columns()->shown(ErrorModel::Pinned) && table_->columns()->shown(ErrorModel::Difference));
    choose("errorModelFilter", QStringLiteral("primal"));
    table_->view()->sortByColumn(ErrorModel::Frame, Qt::AscendingOrder);
    QCOMPARE(cell(6, ErrorModel::ErrorPct), QStringLiteral("17.200"));  // 2 (8 + 0.1 (30 mod 12))
    QCOMPARE(cell(6, ErrorModel::Pinned), QStringLiteral("8.600"));
    QVERIFY2(cell(6, ErrorModel::Difference).contains(QStringLiteral("+8.600 worse")),
             qPrintable(cell(6, ErrorModel::Difference)));
    QCOMPARE(cell(11, ErrorModel::Pinned), QStringLiteral("refused"));
    draw::Selection s = document_->selection();
    s.model = "primal";
    document_->select(s);
    // Held out with an error: frames 6 to 10. Mean of 0.1 ((5 i) mod 12) = 0.1 (6 + 11 + 4 + 9 + 2) / 5 = 0.64.
    QVERIFY2(said("pinnedResult")
                 .contains(QStringLiteral("held-out mean 8.64 % → 17.3 % (5 highlights in 5 frames: 0 better, 5 worse)")),
             qPrintable(said("pinnedResult")));
    QVERIFY2(
        said("pinnedChanges").contains(QStringLiteral("detect.level")) && said("pinnedChanges").contains(QStringLiteral("→ 0.4")),
        qPrintable(said("pinnedChanges")));
    document_->unpin();
    QVERIFY(summary->isHidden() && !table_->columns()->shown(ErrorModel::Pinned));
  }

  void everyViewFlipsAndSaysSo() {
    MainWindow window(fixture_.engine());
    window.resize(1500, 950);
    window.show();
    window.document().open(fixture_.opened());
    QTRY_VERIFY(window.idle() && !window.document().stale());
    Document& document = window.document();
    const auto action = [&](const char* id) { return window.actions().find(QLatin1String(id)); };
    QVERIFY(!action("view.pinned")->isEnabled());
    action("view.pin")->trigger();
    const auto pinned = document.inspection();
    document.setRole(8, FrameRole::Excluded);
    QTRY_VERIFY(window.idle() && !document.stale());
    QVERIFY(document.inspection() != pinned);
    const auto badges = [&] {
      int shown = 0;
      for (const QLabel* badge : window.findChildren<QLabel*>(QStringLiteral("pinnedBadge"))) shown += !badge->isHidden();
      return shown;
    };
    QCOMPARE(badges(), 0);
    const int steps = document.undoStack()->count();
    action("view.pinned")->trigger();
    QVERIFY(document.pinnedShown() && document.inspection() == pinned);
    QCOMPARE(int(document.role(8)), int(FrameRole::HeldOut));
    QCOMPARE(badges(), 2);  // the scene and the frame
    QVERIFY(window.findChild<QDockWidget*>(QStringLiteral("errors"))->windowTitle().contains(QStringLiteral("pinned")));
    QVERIFY(!action("export.json")->isEnabled());
    QCOMPARE(document.undoStack()->count(), steps);
    QVERIFY(document.computed() != pinned);
    // A change concerns computed results, and shows them.
    document.setSetting("detect.level", 0.3);
    QVERIFY(!document.pinnedShown() && badges() == 0 && action("export.json")->isEnabled());
    QTRY_VERIFY(window.idle() && !document.stale());
    QVERIFY(!window.findChild<QDockWidget*>(QStringLiteral("errors"))->windowTitle().contains(QStringLiteral("pinned")));
    action("view.pinned")->trigger();
    QVERIFY(document.pinnedShown());
    action("view.unpin")->trigger();
    QVERIFY(!document.pinnedShown() && !document.pinned() && document.inspection() == document.computed());
    // Another scene has nothing to do with it.
    action("view.pin")->trigger();
    document.open(fixture_.opened());
    QVERIFY(!document.pinned());
    QTRY_VERIFY(window.idle());
  }

 private:
  /// The stand-in's results, errors times `factor`.
  void compute(double factor = 1) {
    auto inspection = std::make_shared<Inspection>(drawnCircles(fixture_.scene(), document_->request()));
    for (auto& [name, model] : inspection->models)
      for (FrameComparison& c : model.frames)
        for (FrameComparison::Row& r : c.rows)
          if (r.metrics) r.metrics->contourErrorPct *= factor;
    document_->setInspection(inspection, document_->request());
  }
  void choose(const char* box, const QString& text) {
    auto* combo = table_->findChild<QComboBox*>(QLatin1String(box));
    QVERIFY2(combo->findText(text) >= 0, qPrintable(text));
    combo->setCurrentIndex(combo->findText(text));
  }
  QString count() const { return table_->findChild<QLabel*>(QStringLiteral("errorCount"))->text(); }
  int rows() const { return table_->view()->model()->rowCount(); }
  QString cell(int row, int column) const { return table_->view()->model()->index(row, column).data().toString(); }

  Fixture fixture_;
  std::unique_ptr<Document> document_;
  std::unique_ptr<ErrorTable> table_;
};

QObject* makeTableTest() { return new TableTest; }

}  // namespace glint::gui

#include "table_test.moc"
