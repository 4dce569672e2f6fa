// SPDX-License-Identifier: BSD-3-Clause
// What Save, Save as and exports may replace, and what a session that was received may read: with the real engine, on copies of a
// session of the repository.
#include <QAction>
#include <QApplication>
#include <QDir>
#include <QDirIterator>
#include <QFile>
#include <QFileDialog>
#include <QFileInfo>
#include <QJsonArray>
#include <QJsonDocument>
#include <QJsonObject>
#include <QLineEdit>
#include <QMessageBox>
#include <QProcess>
#include <QPushButton>
#include <QSettings>
#include <QStatusBar>
#include <QTemporaryDir>
#include <QTimer>

#include "gui/base/text.h"
#include "gui/document/own_files.h"
#include "gui/document/session_file.h"
#include "gui/panels/comparison_panel.h"
#include "gui/window/changed_inputs.h"
#include "gui/window/file_actions.h"
#include "gui/window/main_window.h"
#include "gui/window/message_bar.h"
#include "tests/gui/fixture.h"
#include "tests/gui/folders.h"

namespace glint::gui {

namespace {
const QString kShipped = QStringLiteral(GLINT_SOURCE_DIR "/sessions/plane");

QByteArray contentOf(const QString& file) {
  QFile f(file);
  return f.open(QIODevice::ReadOnly) ? f.readAll() : QByteArray("cannot be read");
}

void write(const QString& file, const QByteArray& content) {
  QFile f(file);
  QVERIFY(f.open(QIODevice::WriteOnly));
  f.write(content);
}

/// Answers the next message box with a button, by its text; what it said.
class Answer : public QObject {
 public:
  explicit Answer(QString button) : button_(std::move(button)) {
    connect(&timer_, &QTimer::timeout, this, [this] {
      auto* box = qobject_cast<QMessageBox*>(QApplication::activeModalWidget());
      if (!box) return;
      said = box->text();
      byDefault = box->defaultButton() ? box->defaultButton()->text().remove('&') : QString();
      ++asked;
      for (QAbstractButton* b : box->buttons())
        if (b->text().remove('&') == button_) return b->click();
      box->reject();
    });
    timer_.start(20);
  }
  QString said, byDefault;
  int asked = 0;

 private:
  QString button_;
  QTimer timer_;
};
}  // namespace

class SaveTest : public QObject {
  Q_OBJECT
 private slots:
  void init() {
    folder_ = std::make_unique<QTemporaryDir>();
    copyFolder(kShipped, path("scene"));
  }

  // --- recovery --------------------------------------------------------------------------------------------------------------

  /// gui-save-overwrites-recovery-of: a session from others says that it is an autosave of some other file.
  void aSessionFromOthersNamesNoFileToSaveTo() {
    write(path("victim.txt"), "mine\n");
    QJsonObject json = QJsonDocument::fromJson(contentOf(path("scene/plane.glint"))).object();
    json["recovery"] = QJsonObject{{"of", path("victim.txt")}, {"session", true}};
    write(path("scene/evil.glint"), QJsonDocument(json).toJson());
    const auto window = opened(path("scene/evil.glint"));
    QVERIFY2(bar(*window).contains("recovery: ignored"), qPrintable(bar(*window)));
    QCOMPARE(window->document().sessionFile(), path("scene/evil.glint"));
    window->document().setSetting("detect.level", 0.4);
    QVERIFY(window->files()->save());
    QTRY_VERIFY(window->idle() && !window->document().hasUnsavedChanges());
    QCOMPARE(contentOf(path("victim.txt")), QByteArray("mine\n"));
    QVERIFY(!contentOf(path("scene/evil.glint")).contains("victim"));
  }

  void whatWasRecoveredAsksBeforeItReplacesTheSession() {
    const Opened state = openInput(path("scene/plane.glint").toStdString());
    QDir().mkpath(recoveryFolder());
    const QString left = recoveryFolder() + "/left.glint";
    coreEngine().autosave(state, left.toStdString());
    const auto window = std::make_unique<MainWindow>(coreEngine());
    window->show();
    window->files()->openRecovered(left, path("scene/plane.glint"));
    QTRY_VERIFY_WITH_TIMEOUT(window->document().scene() && window->idle(), 60000);
    QCOMPARE(window->document().sessionFile(), path("scene/plane.glint"));
    const QByteArray before = contentOf(path("scene/plane.glint"));
    {
      Answer no("Cancel");
      QVERIFY(!window->files()->save());
      QVERIFY2(no.said.contains("recovered"), qPrintable(no.said));
      QCOMPARE(no.byDefault, QStringLiteral("Cancel"));
    }
    QCOMPARE(contentOf(path("scene/plane.glint")), before);
    Answer yes("Replace");
    QVERIFY(window->files()->save());
    QTRY_VERIFY(window->idle() && !window->document().hasUnsavedChanges());
    QCOMPARE(yes.asked, 1);
    window->document().setSetting("detect.level", 0.4);
    QVERIFY(window->files()->save());  // its own now
    QTRY_VERIFY(window->idle() && !window->document().hasUnsavedChanges());
    QCOMPARE(yes.asked, 1);
    QFile::remove(left);
  }

  // --- what Save and Save as replace ------------------------------------------------------------------------------------------

  void aSessionThatAnotherProgramChangedIsAskedFor() {
    const auto window = opened(path("scene/plane.glint"));
    const QByteArray theirs = contentOf(path("scene/plane.glint")).replace("\"notes\": \"\"", "\"notes\": \"theirs\"");
    write(path("scene/plane.glint"), theirs);
    window->document().setSetting("detect.level", 0.4);
    {
      Answer no("Cancel");
      QVERIFY(!window->files()->save());
      QVERIFY2(no.said.contains("changed"), qPrintable(no.said));
      QCOMPARE(no.byDefault, QStringLiteral("Cancel"));
    }
    QCOMPARE(contentOf(path("scene/plane.glint")), theirs);
    Answer yes("Replace");
    QVERIFY(window->files()->save());
    QTRY_VERIFY(window->idle() && !window->document().hasUnsavedChanges());
    QVERIFY(contentOf(path("scene/plane.glint")) != theirs);
  }

  void saveAsAsksBeforeItReplacesASessionAndReplacesNothingElse() {
    QVERIFY(QFile::copy(path("scene/plane.glint"), path("other.glint")));
    write(path("notes"), "mine\n");
    write(path("notes.glint"), "mine, too\n");
    const auto window = opened(path("scene/plane.glint"));
    const QByteArray before = contentOf(path("other.glint")), scene = contentOf(path("scene/scene.json"));
    for (const QString& name : {path("other.glint"), path("other")}) {  // the ending is appended after the dialog
      Answer no("Cancel");
      QVERIFY(!window->files()->saveAsTo(name));
      QCOMPARE(no.asked, 1);
      QCOMPARE(no.byDefault, QStringLiteral("Cancel"));
    }
    QCOMPARE(contentOf(path("other.glint")), before);
    for (const QString& name : {path("notes"), path("notes.glint"), path("scene/scene.json"), path("scene/frames/0000.png")}) {
      Answer none("Replace");
      QVERIFY2(!window->files()->saveAsTo(name), qPrintable(name));
      QCOMPARE(none.asked, 0);
      QVERIFY2(bar(*window).contains("is not a session, so it is not overwritten"), qPrintable(bar(*window)));
    }
    QCOMPARE(contentOf(path("notes.glint")), QByteArray("mine, too\n"));
    QCOMPARE(contentOf(path("scene/scene.json")), scene);
    {
      Answer yes("Replace");
      QVERIFY(window->files()->saveAsTo(path("other")));
      QTRY_VERIFY(window->idle());
      QCOMPARE(yes.asked, 1);
    }
    QCOMPARE(window->document().sessionFile(), path("other.glint"));
    QVERIFY(window->files()->saveAsTo(path("new")));
    QTRY_VERIFY(window->idle() && QFile::exists(path("new.glint")));
  }

  /// A lesson's question about unsaved changes, answered with Enter.
  void whatCameWithTheProgramIsNeverWritten() {
    const QString shipped = QStringLiteral(GLINT_SOURCE_DIR "/sessions/plane/plane.glint");
    QVERIFY(isShipped(shipped) && !isShipped(path("scene/plane.glint")));
    const QByteArray before = contentOf(shipped);
    const auto window = opened(shipped);
    window->document().setSetting("detect.level", 0.4);
    QString title;
    QTimer answer;
    connect(&answer, &QTimer::timeout, this, [&] {
      QWidget* modal = QApplication::activeModalWidget();
      if (auto* box = qobject_cast<QMessageBox*>(modal)) QTest::keyClick(box, Qt::Key_Return);
      if (auto* dialog = qobject_cast<QFileDialog*>(modal)) {
        title = dialog->windowTitle();
        dialog->reject();
      }
    });
    answer.start(50);
    QVERIFY(!window->files()->mayDiscard());
    QCOMPARE(title, QStringLiteral("Save session"));
    title.clear();
    QVERIFY(!window->files()->save());
    QCOMPARE(title, QStringLiteral("Save session"));
    answer.stop();
    QVERIFY(!window->files()->saveAsTo(shipped));
    QVERIFY2(bar(*window).contains("came with the program"), qPrintable(bar(*window)));
    QVERIFY(window->files()->saveAsTo(path("copy.glint")));
    QTRY_VERIFY(window->idle() && !window->document().hasUnsavedChanges());
    QCOMPARE(contentOf(shipped), before);
    QVERIFY(openInput(path("copy.glint").toStdString()).scene != nullptr);
  }

  void anExportReplacesNoFileOfTheInput() {
    const auto window = opened(path("scene/plane.glint"));
    QVERIFY(isOfInput(window->document(), path("scene/frames/0001.png")));
    QVERIFY(isOfInput(window->document(), path("scene/scene.json")));
    QVERIFY(isOfInput(window->document(), path("scene/plane.glint")));
    QVERIFY(!isOfInput(window->document(), path("elsewhere.png")));
    const QByteArray photograph = contentOf(path("scene/frames/0001.png"));
    QString refusal;
    int tried = 0;
    QTimer answer;
    connect(&answer, &QTimer::timeout, this, [&] {
      QWidget* modal = QApplication::activeModalWidget();
      if (auto* box = qobject_cast<QMessageBox*>(modal)) {
        if (box->objectName() == "inputRefusal") refusal = box->text();
        return box->defaultButton() || box->buttons().size() == 1 ? box->buttons().first()->click()
                                                                  : box->button(QMessageBox::Yes)->click();
      }
      if (auto* dialog = qobject_cast<QFileDialog*>(modal)) {
        if (!refusal.isEmpty() || ++tried > 100) return dialog->reject();
        dialog->findChild<QLineEdit*>("fileNameEdit")->setText(path("scene/frames/0001.png"));
        dialog->setOption(QFileDialog::DontConfirmOverwrite);  // its own question is answered already
        QMetaObject::invokeMethod(dialog, "accept");
      }
    });
    answer.start(50);
    window->actions().find("export.plots")->trigger();
    QVERIFY2(refusal.contains("0001.png"), qPrintable(refusal));
    QTRY_VERIFY(window->idle());
    QCOMPARE(contentOf(path("scene/frames/0001.png")), photograph);
  }

  // --- two programs -----------------------------------------------------------------------------------------------------------

  void aSecondWindowOnASessionIsTold() {
    const auto first = opened(path("scene/plane.glint"));
    QVERIFY(!bar(*first).contains("open in"));
    auto second = opened(path("scene/plane.glint"));
    QVERIFY2(bar(*second).contains("is also open in another window of this program"), qPrintable(bar(*second)));
    second->document().setSetting("detect.level", 0.4);
    {
      Answer no("Cancel");
      QVERIFY(!second->files()->save());
      QVERIFY2(no.said.contains("is also open in another window"), qPrintable(no.said));
    }
    QCOMPARE(QDir(path("scene")).entryList(QDir::Files), (QStringList{"plane.glint", "scene.json"}));  // no lock beside it
    second->document().undoStack()->undo();
    second.reset();
    first->document().setSetting("detect.level", 0.3);
    QVERIFY(first->files()->save());  // asks nothing
    QTRY_VERIFY(first->idle() && !first->document().hasUnsavedChanges());
  }

  /// A program that is killed leaves its lock behind.
  void aDeadProgramsLockCountsForNothing() {
    SessionLock cleansFirst;
    QProcess dead;
    dead.start("sleep", {"600"});
    QVERIFY(dead.waitForStarted());
    const QByteArray lock =
        QByteArray::number(dead.processId()) + "\nglint-inspector\n" + QSysInfo::machineHostName().toUtf8() + "\n";
    dead.kill();
    QVERIFY(dead.waitForFinished());
    {
      const auto window = opened(path("scene/plane.glint"));
      const QStringList files = QDir(locksFolder()).entryList(QDir::Files);
      QCOMPARE(files.size(), 1);
      lockFile_ = locksFolder() + '/' + files.first();
    }
    QVERIFY(!QFile::exists(lockFile_));
    write(lockFile_, lock);
    const auto window = opened(path("scene/plane.glint"));
    QVERIFY2(!bar(*window).contains("open in"), qPrintable(bar(*window)));
    write(locksFolder() + "/left.lock", lock);
    const SessionLock cleans;
    QVERIFY(!QFile::exists(locksFolder() + "/left.lock"));
  }

  // --- received sessions -------------------------------------------------------------------------------------------------------

  void aSessionThatNamesFilesOutsideAsksAndThePersonsYesIsKeptOutsideOfIt() {
    QVERIFY(QDir().rename(path("scene/frames"), path("elsewhere")));
    QJsonObject json = QJsonDocument::fromJson(contentOf(path("scene/plane.glint"))).object();
    QJsonObject input = json["input"].toObject();
    input["folders"] = QJsonArray{QJsonObject{{"of", "photographs"}, {"folder", "../elsewhere"}}};
    input["allow_outside"] = true;  // counts for nothing
    json["input"] = input;
    const QString session = path("scene/received.glint");
    write(session, QJsonDocument(json).toJson());
    const QByteArray before = contentOf(session);
    auto window = std::make_unique<MainWindow>(coreEngine());
    window->show();
    window->open(session);
    QPushButton* allow = nullptr;
    QTRY_VERIFY_WITH_TIMEOUT((allow = button(*window, "Allow and open")) != nullptr, 20000);
    QVERIFY2(
        bar(*window).contains("input.folders[0].folder") && bar(*window).contains("elsewhere") && !bar(*window).contains("--"),
        qPrintable(bar(*window)));
    QVERIFY(!window->document().scene());
    QTest::mouseClick(allow, Qt::LeftButton);
    QTRY_VERIFY_WITH_TIMEOUT(window->document().scene() && window->idle() && window->document().inspection(), 60000);
    QVERIFY(!window->document().inspection()->evidence[0].failure);
    QTRY_VERIFY(!window->findChild<ChangedInputs*>()->busy());
    QVERIFY(window->findChild<ChangedInputs*>()->all().isEmpty());  // of files outside nothing is said
    QCOMPARE(contentOf(session), before);
    window = opened(session);  // remembered
    QVERIFY(!button(*window, "Allow and open"));
    window->comparison()->compareWith(session);  // and where it is read to be compared
    QTRY_VERIFY_WITH_TIMEOUT(window->comparison()->comparison() && window->idle(), 60000);
    // The permission is for this session alone: a copy of it is another session.
    QVERIFY(QFile::copy(session, path("scene/copy.glint")));
    const std::shared_ptr<const Scene> scene = window->document().sharedScene();
    QString said;
    connect(window.get(), &MainWindow::problem, this, [&said](const QString& line) { said = line; });
    window->comparison()->compareWith(path("scene/copy.glint"));
    QTRY_VERIFY_WITH_TIMEOUT(!said.isEmpty() && window->idle(), 20000);
    QVERIFY2(said.contains("elsewhere") && said.contains("open that session itself") && !said.contains("--"), qPrintable(said));
    window->open(path("scene/copy.glint"));
    QTRY_VERIFY_WITH_TIMEOUT(button(*window, "Allow and open") != nullptr, 20000);
    QVERIFY(window->document().sharedScene() == scene);
  }

  void aScriptIsRefusedInOneLine() {
    QVERIFY(QDir().rename(path("scene/frames"), path("elsewhere")));
    QJsonObject json = QJsonDocument::fromJson(contentOf(path("scene/plane.glint"))).object();
    QJsonObject input = json["input"].toObject();
    input["folders"] = QJsonArray{QJsonObject{{"of", "photographs"}, {"folder", "../elsewhere"}}};
    json["input"] = input;
    write(path("scene/received.glint"), QJsonDocument(json).toJson());
    QProcess program;
    program.start(QStringLiteral(GLINT_INSPECTOR),
                  {path("scene/received.glint"), "--screenshot", path("shot.png"), "--wait-idle"});
    QVERIFY(program.waitForFinished(120000));
    QCOMPARE(program.exitCode(), 2);
    const QByteArray said = program.readAllStandardError();
    QCOMPARE(said.count('\n'), 1);
    QVERIFY2(said.contains("input.folders[0].folder"), said.constData());
    QVERIFY(!QFile::exists(path("shot.png")));
  }

 private:
  QString path(const QString& name) const { return folder_->filePath(name); }
  static QString bar(MainWindow& window) {
    auto* bar = window.findChild<MessageBar*>(QStringLiteral("messageBar"));
    return bar->isVisible() ? bar->text() : QString();
  }
  static QPushButton* button(MainWindow& window, const char* text) {
    auto* bar = window.findChild<MessageBar*>(QStringLiteral("messageBar"));
    for (QPushButton* b : bar->findChildren<QPushButton*>())
      if (bar->isVisible() && b->isVisible() && b->text() == QLatin1String(text)) return b;
    return nullptr;
  }
  static std::unique_ptr<MainWindow> opened(const QString& file) {
    auto window = std::make_unique<MainWindow>(coreEngine());
    window->show();
    window->open(file);
    [&] {
      QTRY_VERIFY_WITH_TIMEOUT(window->document().scene() && window->idle() && window->document().inspection(), 60000);
      QTRY_VERIFY(!window->findChild<ChangedInputs*>()->busy());
    }();
    return window;
  }
  std::unique_ptr<QTemporaryDir> folder_;
  QString lockFile_;
};

QObject* makeSaveTest() { return new SaveTest; }

}  // namespace glint::gui

#include "save_test.moc"
