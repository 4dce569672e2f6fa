// SPDX-License-Identifier: BSD-3-Clause
// Kill and recover; a scene that was moved. With the real engine on a session of the repository.
#include <QDateTime>
#include <QDir>
#include <QFile>
#include <QFileInfo>
#include <QProcess>
#include <QPushButton>
#include <QTemporaryDir>
#include <QUndoView>
#include <csignal>

#include "gui/base/text.h"
#include "gui/document/session_file.h"
#include "gui/window/autosave.h"
#include "gui/window/file_actions.h"
#include "gui/window/main_window.h"
#include "gui/window/message_bar.h"
#include "tests/gui/fixture.h"
#include "tests/gui/folders.h"

namespace glint::gui {

namespace {
const char* const kSession = GLINT_SOURCE_DIR "/sessions/plane/plane.glint";

void openAndWait(MainWindow& window, const QString& path) {
  window.open(path);
  QTRY_VERIFY_WITH_TIMEOUT(window.document().scene() && window.idle() && window.document().inspection(), 60000);
}

QPushButton* answer(MainWindow& window, const char* title) {
  auto* bar = window.findChild<MessageBar*>(QStringLiteral("messageBar"));
  for (QPushButton* button : bar->findChildren<QPushButton*>())
    if (bar->isVisible() && button->text() == QString::fromUtf8(title)) return button;
  return nullptr;
}

}  // namespace

/// What the killed program does: three changes, then it dies without a farewell.
int runUntilKilled() {
  MainWindow window(coreEngine());
  window.show();
  window.open(QString::fromUtf8(kSession));
  if (!QTest::qWaitFor([&] { return window.document().scene() && window.document().inspection(); }, 60000)) return 3;
  window.document().setSetting("detect.level", 0.4);
  window.document().setRole(5, FrameRole::Excluded);
  window.document().setLayerVisible("rays", "Rays", true);
  window.findChild<Autosave*>()->flush();  // the last action has been written; one after it would be the one that is lost
  window.document().setOption("frame/gamma", 2.0, "Gamma");
  ::raise(SIGKILL);
  return 4;
}

class RecoveryTest : public QObject {
  Q_OBJECT
 private slots:
  void aKilledProgramLosesAtMostItsLastAction() {
    QProcess victim;
    victim.start(QCoreApplication::applicationFilePath(), {"--until-killed"});
    QVERIFY(victim.waitForFinished(120000));
    QCOMPARE(victim.exitStatus(), QProcess::CrashExit);

    MainWindow window(coreEngine());
    window.show();
    QPushButton* recover = answer(window, "Recover");
    QVERIFY(recover);
    QTest::mouseClick(recover, Qt::LeftButton);
    QTRY_VERIFY_WITH_TIMEOUT(window.document().scene() && window.idle() && window.document().inspection(), 60000);
    QCOMPARE(window.document().request().settings.number("detect.level"), 0.4);
    QCOMPARE(window.document().role(5), FrameRole::Excluded);
    QVERIFY(window.document().layerVisible("rays"));
    QVERIFY(window.document().hasUnsavedChanges());
    const auto* history = window.findChild<QUndoView*>(QStringLiteral("historyList"));
    QCOMPARE(history->emptyLabel(), QStringLiteral("As recovered; earlier steps are lost"));
    QCOMPARE(QFileInfo(window.document().sessionFile()).canonicalFilePath(), QFileInfo(kSession).canonicalFilePath());
    // This program keeps it now; the dead one's file is gone, and it is not offered twice.
    Autosave* autosave = window.findChild<Autosave*>();
    QTRY_VERIFY(!autosave->leftBehind());
    QVERIFY(QFile::exists(autosave->file()));
    MainWindow another(coreEngine());
    QVERIFY(!answer(another, "Recover"));
  }

  void whatIsSavedOrGivenUpLeavesNothing() {
    QString file;
    {
      MainWindow window(coreEngine());
      window.show();
      openAndWait(window, kSession);
      QCOMPARE(window.findChild<QUndoView*>(QStringLiteral("historyList"))->emptyLabel(), QStringLiteral("As opened"));
      Autosave* autosave = window.findChild<Autosave*>();
      file = autosave->file();
      window.document().setSetting("detect.level", 0.4);
      autosave->flush();
      QVERIFY(QFile::exists(file));
      window.document().undoStack()->undo();
      autosave->flush();
      QVERIFY2(!QFile::exists(file), "back at what is saved");
      window.document().setSetting("detect.level", 0.3);
    }
    QVERIFY(!QFile::exists(file));
    MainWindow window(coreEngine());
    QVERIFY(!answer(window, "Recover"));
  }

  void whatARunningProgramHoldsIsNotOffered() {
    MainWindow running(coreEngine());
    running.show();
    openAndWait(running, kSession);
    running.document().setSetting("detect.level", 0.4);
    running.findChild<Autosave*>()->flush();
    QVERIFY(QFile::exists(running.findChild<Autosave*>()->file()));
    MainWindow another(coreEngine());
    QVERIFY(!answer(another, "Recover"));
    QVERIFY(!another.findChild<Autosave*>()->leftBehind());
  }

  void theNewestIsOfferedFirst() {
    const QString folder = folder_.filePath("left");
    QDir().mkpath(folder);
    const Opened opened = openInput(kSession);
    for (const char* name : {"a", "newest", "z"}) {
      const QString file = folder + '/' + name + ".glint";
      engine_.autosave(opened, file.toStdString());
      QFile touched(file);
      QVERIFY(touched.open(QIODevice::ReadWrite));
      QVERIFY(touched.setFileTime(QDateTime::currentDateTime().addSecs(qstrcmp(name, "newest") == 0 ? -60 : -3600),
                                  QFileDevice::FileModificationTime));
    }
    const Autosave autosave(
        engine_, document_, [] { return Opened(); }, folder);
    const std::optional<Autosave::Found> found = autosave.leftBehind();
    QVERIFY(found);
    QCOMPARE(QFileInfo(found->file).fileName(), QStringLiteral("newest.glint"));
    QCOMPARE(QFileInfo(found->of).canonicalFilePath(), QFileInfo(kSession).canonicalFilePath());
    Autosave::discard(*found);
    QVERIFY(autosave.leftBehind() && autosave.leftBehind()->file != found->file);
  }

  void aFileThatIsCutIsNotOffered() {
    const QString folder = QFileInfo(Autosave(
                                         engine_, document_, [] { return Opened(); }, folder_.path())
                                         .file())
                               .path();
    QFile cut(folder + "/broken.glint");
    QVERIFY(cut.open(QIODevice::WriteOnly));
    cut.write("{\"glint_session\": 2, \"inp");
    cut.close();
    QVERIFY(!Autosave(
                 engine_, document_, [] { return Opened(); }, folder)
                 .leftBehind());
  }

  void aMovedSceneIsLocatedAndTheSessionRemembersIt() {
    const QString old = folder_.filePath("old"), moved = folder_.filePath("moved/deep");
    copyFolder(QFileInfo(kSession).path(), old);
    QDir().mkpath(moved);
    for (const char* part : {"scene.json", "frames"}) QVERIFY(QFile::rename(old + '/' + part, moved + '/' + part));
    MainWindow window(coreEngine());
    window.show();
    window.open(old + "/plane.glint");
    QTRY_VERIFY_WITH_TIMEOUT(answer(window, "Locate…"), 20000);
    QVERIFY(window.lastError().contains("scene.json") && !window.lastError().contains('\n'));
    window.files()->openRelinked(old + "/plane.glint", {(moved + "/scene.json").toStdString()});  // what the dialog's answer does
    QTRY_VERIFY_WITH_TIMEOUT(window.document().scene() && window.idle() && window.document().inspection(), 60000);
    QVERIFY(window.document().hasUnsavedChanges());
    QVERIFY(window.files()->save());
    QTRY_VERIFY_WITH_TIMEOUT(window.idle() && !window.document().hasUnsavedChanges(), 60000);
    MainWindow again(coreEngine());
    again.show();
    openAndWait(again, old + "/plane.glint");
    QCOMPARE(QFileInfo(toQString(again.document().scene()->file.string())).canonicalFilePath(),
             QFileInfo(moved + "/scene.json").canonicalFilePath());
    QVERIFY(!again.document().hasUnsavedChanges());
  }

  void anotherSceneInItsPlaceIsTold() {
    const QString other = folder_.filePath("other");
    copyFolder(QFileInfo(kSession).path(), other);
    QFile scene(other + "/scene.json");
    QVERIFY(scene.open(QIODevice::Append));
    scene.write("\n");  // the same scene, but not the same file
    scene.close();
    const Opened opened = openInput(kSession, {(other + "/scene.json").toStdString()});
    QVERIFY(toQString(opened.warning).contains("differs from the "));
    QVERIFY(opened.unsaved);
  }

 private:
  QTemporaryDir folder_;
  Engine engine_ = coreEngine();
  Document document_{engine_.parseTrain};
};

QObject* makeRecoveryTest() { return new RecoveryTest; }

}  // namespace glint::gui

#include "recovery_test.moc"
