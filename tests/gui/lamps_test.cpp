// SPDX-License-Identifier: BSD-3-Clause
// Lamps measured in the window, by real clicks: the same to the last bit as what `glint lights` writes.
#include <QAction>
#include <QApplication>
#include <QDialogButtonBox>
#include <QFile>
#include <QFileDialog>
#include <QLabel>
#include <QLineEdit>
#include <QProcess>
#include <QPushButton>
#include <QTimer>

#include "gui/base/text.h"
#include "gui/document/session_file.h"
#include "gui/lamps/lamp_table.h"
#include "gui/lamps/lamps_in_window.h"
#include "gui/lamps/lamps_panel.h"
#include "gui/window/docks.h"
#include "gui/window/main_window.h"
#include "tests/gui/fixture.h"

namespace glint::gui {

namespace {

const QString kTwoLamps = QStringLiteral(GLINT_SOURCE_DIR "/sessions/two-lamps/scene.json");

QByteArray bytesOf(const QString& file) {
  QFile f(file);
  return f.open(QIODevice::ReadOnly) ? f.readAll() : QByteArray();
}

/// What the command line writes for the same input.
QByteArray byCommand(const QStringList& arguments, const QString& output) {
  QProcess program;
  program.start(QStringLiteral(GLINT_CLI), QStringList{"lights"} + arguments + QStringList{"-o", output});
  return program.waitForFinished(120000) && program.exitCode() == 0 ? bytesOf(output) : program.readAllStandardError();
}

/// Types a name into the dialog that opens next, and saves.
void answerWith(QTimer& timer, const QString& file) {
  QObject::connect(&timer, &QTimer::timeout, [file] {
    auto* dialog = qobject_cast<QFileDialog*>(QApplication::activeModalWidget());
    if (!dialog) return;
    dialog->findChild<QLineEdit*>(QStringLiteral("fileNameEdit"))->setText(file);
    QTest::mouseClick(dialog->findChild<QDialogButtonBox*>()->button(QDialogButtonBox::Save), Qt::LeftButton);
  });
  timer.start(50);
}

}  // namespace

class LampsTest : public QObject {
  Q_OBJECT
 private slots:
  void init() { folder_ = std::make_unique<QTemporaryDir>(); }

  void theLampsOfASceneAreThoseOfTheCommand() {
    MainWindow window(knownEngine());
    window.resize(1500, 950);
    window.show();
    window.open(kTwoLamps);
    QTRY_VERIFY_WITH_TIMEOUT(window.document().inspection() && window.idle(), 120000);
    LampsPanel* panel = window.lamps()->panel();
    QVERIFY(Docks::isBehind(panel));  // nothing is measured before a person asks
    QVERIFY(!window.lamps()->ofScene()->lamps());
    window.actions().find(QStringLiteral("lamps.measure"))->trigger();
    QTRY_VERIFY_WITH_TIMEOUT(window.lamps()->ofScene()->lamps() && window.idle(), 120000);
    QVERIFY(panel->isVisible() && !Docks::isBehind(panel));
    const LampsPtr lamps = window.lamps()->ofScene()->lamps();
    QCOMPARE(panel->table()->model()->rowCount(), int(lamps->lamps.size()));
    QVERIFY(!panel->table()->accessibleName().isEmpty());

    for (const char* ending : {"json", "csv"}) {
      const QString file = folder_->filePath(QStringLiteral("window.") + ending);
      QTimer answers;
      answerWith(answers, file);
      QTest::mouseClick(panel->findChild<QPushButton*>(QStringLiteral("saveLamps")), Qt::LeftButton);
      const QByteArray expected = byCommand({kTwoLamps}, folder_->filePath(QStringLiteral("command.") + ending));
      QVERIFY2(expected.size() > 100, expected);
      QCOMPARE(bytesOf(file), expected);
    }
    selectsBothWays(window);
    becomesStale(window);
  }

  void aSessionThatWasSavedWithLampsMeasuresThemAgain() {
    const std::string file = folder_->filePath(QStringLiteral("lamps.glint")).toStdString();
    Opened opened = openInput(kTwoLamps.toStdString());
    opened.options["lamps/measured"] = "1";
    saveSession(opened, nullptr, file);
    MainWindow window(knownEngine());
    window.resize(1500, 950);
    window.show();
    window.open(toQString(file));
    QTRY_VERIFY_WITH_TIMEOUT(window.lamps()->ofScene()->lamps() && window.idle(), 120000);
    QVERIFY(window.document().inspection());
    // The next file says it again, whatever is undone; a scene that is opened then does not have it.
    QCOMPARE(QString::fromStdString(window.document().toSave().options.at("lamps/measured")), QStringLiteral("1"));
    window.open(kTwoLamps);
    QTRY_VERIFY_WITH_TIMEOUT(window.document().inspection() && window.idle(), 120000);
    QVERIFY(!window.lamps()->ofScene()->lamps());
    QVERIFY(!window.document().toSave().options.count("lamps/measured"));
  }

  /// What is said of each lamp does not push the table out of sight.
  void theTableSaysInWhatLampsStandStillAndStaysInSight() {
    LampsReport report;
    report.lengthUnit = "m";
    for (int i = 0; i < 13; ++i) {
      LampAnswer lamp;
      lamp.id = "dome-" + std::to_string(i);
      lamp.frame = i == 0 ? LightFrame::Camera : LightFrame::World;
      lamp.frameReason = "as was measured";
      report.lamps.push_back(lamp);
      report.warnings.push_back(lamp.id + ": the scene states this lamp");
    }
    LampsPanel panel;
    panel.resize(600, 280);
    panel.setVisible(true);
    panel.show(&report, {});
    QVERIFY(QTest::qWaitForWindowExposed(&panel));
    const QAbstractItemModel* table = panel.table()->model();
    QCOMPARE(table->headerData(LampTable::StandsStillIn, Qt::Horizontal).toString(), QStringLiteral("stands still in"));
    QCOMPARE(table->index(0, LampTable::StandsStillIn).data().toString(), QStringLiteral("camera"));
    QCOMPARE(table->index(1, LampTable::StandsStillIn).data().toString(), QStringLiteral("world"));
    QVERIFY(
        table->index(0, LampTable::StandsStillIn).data(Qt::ToolTipRole).toString().contains(QStringLiteral("as was measured")));
    QCOMPARE(table->headerData(LampTable::Position, Qt::Horizontal).toString(), QStringLiteral("position"));
    auto* warnings = panel.findChild<QLabel*>(QStringLiteral("lampsWarnings"));
    QCOMPARE(warnings->text().split('\n').size(), 4);
    QVERIFY2(warnings->text().endsWith(QStringLiteral("and 10 more: see the table's last column")), qPrintable(warnings->text()));
    QVERIFY(warnings->toolTip().contains(QStringLiteral("dome-12")));
    QVERIFY2(panel.table()->height() > 100, qPrintable(QString::number(panel.table()->height())));
  }

  void stoppingLeavesNothing() {
    Engine engine = knownEngine();
    std::atomic<bool> running{false};
    engine.lamps = [&running](const std::shared_ptr<const Scene>&, const InspectionRequest&, const std::string&,
                              const ProgressFn& go, const Inspection*) -> LampsReport {
      running = true;
      while (go({"lamps", 1, 3})) QThread::msleep(5);
      throw Stopped{};
    };
    MainWindow window(engine);
    window.show();
    window.open(kTwoLamps);
    QTRY_VERIFY_WITH_TIMEOUT(window.document().inspection() && window.idle(), 120000);
    window.actions().find(QStringLiteral("lamps.measure"))->trigger();
    QTRY_VERIFY(running);
    auto* stop = window.lamps()->panel()->findChild<QPushButton*>(QStringLiteral("stopLamps"));
    QTRY_VERIFY(stop->isVisible());
    QTest::mouseClick(stop, Qt::LeftButton);
    QTRY_VERIFY(window.idle());
    QVERIFY(!window.lamps()->ofScene()->lamps());
    QVERIFY(window.lamps()->panel()->findChild<QPushButton*>(QStringLiteral("measureLamps"))->isEnabled());
    // Escape stops it, too.
    running = false;
    window.actions().find(QStringLiteral("lamps.measure"))->trigger();
    QTRY_VERIFY(running);
    window.actions().find(QStringLiteral("edit.stop"))->trigger();
    QTRY_VERIFY(window.idle());
  }

  void aFailureIsOneLine() {
    Engine engine = knownEngine();
    engine.lamps = [](const std::shared_ptr<const Scene>&, const InspectionRequest&, const std::string&, const ProgressFn&,
                      const Inspection*) -> LampsReport { throw InputError("a.png", "frame 3", "is damaged"); };
    MainWindow window(engine);
    window.show();
    window.open(kTwoLamps);
    QTRY_VERIFY_WITH_TIMEOUT(window.document().inspection() && window.idle(), 120000);
    window.actions().find(QStringLiteral("lamps.measure"))->trigger();
    QTRY_VERIFY2(window.lastError().contains("is damaged"), qPrintable(window.lastError()));
    QVERIFY(!window.lamps()->ofScene()->lamps());
  }

 private:
  void selectsBothWays(MainWindow& window) {
    LampTable* table = window.lamps()->panel()->table();
    const LampsPtr lamps = window.lamps()->ofScene()->lamps();
    QVERIFY(lamps->lamps.size() >= 2);
    for (int row = 0; row < 2; ++row) {
      const QModelIndex cell = table->model()->index(row, LampTable::Lamp);
      QTest::mouseClick(table->viewport(), Qt::LeftButton, {}, table->visualRect(cell).center());
      QCOMPARE(window.document().selection().light, lamps->lamps[std::size_t(row)].id);
    }
    draw::Selection s = window.document().selection();
    s.light = lamps->lamps[0].id;
    window.document().select(s);
    QCOMPARE(table->currentLamp(), 0);
  }

  /// Lamps depend on the level, not on training frames.
  void becomesStale(MainWindow& window) {
    auto* badge = window.lamps()->panel()->findChild<QLabel*>(QStringLiteral("staleBadge"));
    QVERIFY(badge);
    QVERIFY(window.document().setTrain("first:3"));
    QTest::qWait(400);
    QVERIFY(!badge->isVisible());
    window.document().setSetting("detect.level", 0.4);
    QTRY_VERIFY(badge->isVisible());
    QTRY_VERIFY_WITH_TIMEOUT(window.idle(), 120000);
  }

  std::unique_ptr<QTemporaryDir> folder_;
};

QObject* makeLampsTest() { return new LampsTest; }

}  // namespace glint::gui

#include "lamps_test.moc"
