// SPDX-License-Identifier: BSD-3-Clause
// Two sessions side by side, and the minimal session of a fault.
#include <QAction>
#include <QCheckBox>
#include <QDir>
#include <QFileInfo>
#include <QHeaderView>
#include <QLabel>
#include <QPushButton>
#include <QTabWidget>
#include <QTableView>

#include "core/app/session.h"
#include "gui/base/rows_model.h"
#include "gui/document/session_file.h"
#include "gui/export/export_actions.h"
#include "gui/export/repro_actions.h"
#include "gui/panels/comparison_panel.h"
#include "gui/window/main_window.h"
#include "gui/window/message_bar.h"
#include "tests/gui/fixture.h"

namespace glint::gui {

class ComparisonTest : public QObject {
  Q_OBJECT
 private slots:
  void init() {
    problem_.clear();
    window_ = std::make_unique<MainWindow>(knownEngine());
    connect(window_.get(), &MainWindow::problem, this, [this](const QString& line) { problem_ = line; });
    window_->show();
    window_->open(QStringLiteral(GLINT_SOURCE_DIR "/sessions/plane/plane.glint"));
    QTRY_VERIFY_WITH_TIMEOUT(window_->document().inspection() && window_->idle(), 60000);
  }
  void cleanup() { window_.reset(); }

  void whatChangedAndTheErrorsOfBoth() {
    Document& d = window_->document();
    const QString before = folder_.filePath("before.glint");
    saveSession(d.toSave(), d.inspection().get(), before.toStdString());
    d.setSetting("detect.level", 0.35);
    d.setRole(5, FrameRole::Excluded);
    QTRY_VERIFY_WITH_TIMEOUT(window_->idle() && !d.stale(), 60000);
    window_->comparison()->compareWith(before);
    QTRY_VERIFY_WITH_TIMEOUT(window_->idle(), 60000);
    QVERIFY2(problem_.isEmpty(), qPrintable(problem_));
    auto* values = window_->findChild<QTableView*>("comparedValues");
    auto* errors = window_->findChild<QTableView*>("comparedErrors");
    QVERIFY(values->isVisible());  // it came to the front
    QStringList rows;
    for (int r = 0; r < values->model()->rowCount(); ++r)
      rows << values->model()->index(r, 1).data().toString() + ": " + values->model()->index(r, 2).data().toString() + " / " +
                  values->model()->index(r, 3).data().toString();
    QVERIFY2(rows.contains("detect.level: 0.35 / 0.5"), qPrintable(rows.join('\n')));
    QVERIFY2(rows.contains("excluded frames: 0005 / –"), qPrintable(rows.join('\n')));
    for (const QString& row : rows) QVERIFY2(!row.startsWith("models"), qPrintable(row));  // the same in both

    const int differing = errors->model()->rowCount();
    QVERIFY(differing > 0);
    window_->findChild<QCheckBox*>("onlyDifferences")->setChecked(false);
    QVERIFY(values->model()->rowCount() > rows.size() + 20);
    QCOMPARE(errors->model()->rowCount(), int(window_->comparison()->comparison()->errors.size()));

    auto* models = window_->findChild<QTableView*>("comparedModels");
    QCOMPARE(models->model()->rowCount(), int(d.request().models.size()));
    window_->comparison()->findChild<QTabWidget*>()->setCurrentWidget(errors);
    // Numbers are sorted as numbers; a click selects the frame and the model in every view.
    errors->sortByColumn(3, Qt::DescendingOrder);
    double last = 1e300;
    for (int r = 0; r < errors->model()->rowCount(); ++r) {
      const double v = errors->model()->index(r, 3).data(RowsModel::kSortRole).toDouble();
      QVERIFY(v <= last);
      last = v;
    }
    const QModelIndex row = errors->model()->index(1, 0);
    errors->scrollTo(row);
    QTest::mouseClick(errors->viewport(), Qt::LeftButton, {}, errors->visualRect(row).center());
    QCOMPARE(QString::fromStdString(d.scene()->frames[std::size_t(d.selection().frame)].id), row.data().toString());
    QCOMPARE(QString::fromStdString(d.selection().model), row.sibling(1, 1).data().toString());

    QVERIFY(!window_->findChild<QLabel*>("comparisonTitle")->text().contains("changed since"));
    d.setSetting("detect.level", 0.45);
    QTRY_VERIFY_WITH_TIMEOUT(window_->idle() && !d.stale(), 60000);
    QVERIFY(window_->findChild<QLabel*>("comparisonTitle")->text().contains("changed since"));
  }

  /// Names of sessions can be long: the title is cut, and does not push the other docks away.
  void aLongTitleDoesNotWidenTheDock() {
    ComparisonPanel* panel = window_->comparison();
    auto* title = panel->findChild<QLabel*>("comparisonTitle");
    const int before = panel->minimumSizeHint().width();
    title->setText(QString(400, QLatin1Char('m')));
    QTRY_VERIFY(title->sizeHint().width() > 2000);
    QCoreApplication::sendPostedEvents(nullptr, QEvent::LayoutRequest);
    QCOMPARE(panel->minimumSizeHint().width(), before);
  }

  void namesTellFilesApart() {
    using Names = std::pair<QString, QString>;
    QCOMPARE(shortestNames("/a/x.glint", "/a/y.glint"), Names("x.glint", "y.glint"));
    QCOMPARE(shortestNames("/p/a/x.glint", "/p/b/x.glint"), Names("a/x.glint", "b/x.glint"));
    QCOMPARE(shortestNames("/p/a/c/x.glint", "/p/b/c/x.glint"), Names("a/c/x.glint", "b/c/x.glint"));
    QCOMPARE(shortestNames("/a/x.glint", "/a/x.glint"), Names("x.glint", "x.glint"));
    // In the window, with the same name in another folder.
    QDir(folder_.path()).mkpath("other");
    const QString other = folder_.filePath("other/plane.glint");
    saveSession(window_->document().toSave(), window_->document().inspection().get(), other.toStdString());
    window_->comparison()->compareWith(other);
    QTRY_VERIFY_WITH_TIMEOUT(window_->idle(), 60000);
    auto* title = window_->findChild<QLabel*>("comparisonTitle");
    QVERIFY2(title->text().contains("A: plane/plane.glint") && title->text().contains("B: other/plane.glint"),
             qPrintable(title->text()));
    QVERIFY2(title->toolTip().contains("B: " + QDir::toNativeSeparators(other)), qPrintable(title->toolTip()));
  }

  void whatCannotBeReadIsSaid() {
    window_->comparison()->compareWith(folder_.filePath("none.glint"));
    QTRY_VERIFY_WITH_TIMEOUT(window_->idle() && !problem_.isEmpty(), 20000);
    QVERIFY(problem_.contains("none.glint"));
    QVERIFY(!window_->comparison()->comparison());
  }

  void aMinimalSessionOpensAndShowsTheFault() {
    Document& d = window_->document();
    int frame = 0;
    while (!d.inspection()->isHeldOut(frame)) ++frame;
    draw::Selection s = d.selection();
    s.frame = frame;
    s.model = "limit-angle";
    d.select(s);
    const Outcome<Fault> fault = window_->exports()->repro()->fault();
    QVERIFY(fault && fault->errorPct);
    const QString folder = folder_.filePath("minimal");
    window_->exports()->repro()->write(*fault, {FaultKept::AtLeast, 0.2}, folder);
    QTRY_VERIFY_WITH_TIMEOUT(window_->idle(), 60000);
    QVERIFY2(problem_.isEmpty(), qPrintable(problem_));
    // The result stays on screen until it is answered or closed, and is no error.
    auto* bar = window_->findChild<MessageBar*>();
    QVERIFY(bar && bar->isVisibleTo(window_.get()));
    QVERIFY2(bar->text().contains("training frames") && bar->text().contains("repro.glint"), qPrintable(bar->text()));
    QVERIFY(window_->lastError().isEmpty());
    const QList<QPushButton*> answers = bar->findChildren<QPushButton*>();
    QCOMPARE(answers.size(), 1);
    QCOMPARE(answers[0]->text(), QStringLiteral("Open"));
    QTest::mouseClick(answers[0], Qt::LeftButton);
    QVERIFY(!bar->isVisibleTo(window_.get()));
    QTRY_VERIFY_WITH_TIMEOUT(d.sessionFile().contains("repro.glint") && window_->idle() && !d.stale(), 60000);
    const Outcome<Fault> now = window_->exports()->repro()->fault();  // the session selects frame and model
    QVERIFY(now && now->errorPct);
    QVERIFY2(*now->errorPct >= 0.8 * *fault->errorPct, qPrintable(QString::number(*now->errorPct)));
    QVERIFY(replay(readSession((folder + "/repro.glint").toStdString())).differences.empty());
  }

 private:
  QTemporaryDir folder_;
  QString problem_;
  std::unique_ptr<MainWindow> window_;
};

QObject* makeComparisonTest() { return new ComparisonTest; }

}  // namespace glint::gui

#include "comparison_test.moc"
