// SPDX-License-Identifier: BSD-3-Clause
// A mesh that is not where the scene says, depth maps, normal maps and masks: asked for, found elsewhere, remembered; and the
// command that names such places.
#include <QAction>
#include <QApplication>
#include <QClipboard>
#include <QDialogButtonBox>
#include <QDir>
#include <QDirIterator>
#include <QFile>
#include <QFileDialog>
#include <QImage>
#include <QJsonArray>
#include <QJsonDocument>
#include <QJsonObject>
#include <QLineEdit>
#include <QMessageBox>
#include <QPointer>
#include <QProcess>
#include <QPushButton>
#include <QTimer>

#include "core/app/session.h"
#include "gui/base/text.h"
#include "gui/document/own_files.h"
#include "gui/document/session_file.h"
#include "gui/timeline/timeline.h"
#include "gui/window/changed_inputs.h"
#include "gui/window/file_actions.h"
#include "gui/window/main_window.h"
#include "gui/window/message_bar.h"
#include "gui/window/unreadable_files.h"
#include "tests/gui/fixture.h"
#include "tests/gui/folders.h"

namespace glint::gui {

namespace {
const QString kMesh = QStringLiteral("mesh/geom_00.ply");

void move(const QString& from, const QString& to) {
  QVERIFY2(QDir().mkpath(QFileInfo(to).path()) && QDir().rename(from, to), qPrintable(from + " " + to));
}

QPushButton* locateButton(MainWindow& window) {
  auto* bar = window.findChild<MessageBar*>(QStringLiteral("messageBar"));
  for (QPushButton* button : bar->findChildren<QPushButton*>())
    if (bar->isVisible() && button->isVisible() && button->text() == QString::fromUtf8("Locate…")) return button;
  return nullptr;
}

/// Presses the real button and answers the dialog for files or folders that it opens; "" = Cancel. The dialog's title.
QString locate(MainWindow& window, const QString& file) {
  QString title;
  QPushButton* button = nullptr;
  if (!QTest::qWaitFor([&] { return (button = locateButton(window)) != nullptr && window.idle(); }, 20000)) {
    QTest::qFail(qPrintable("nothing to locate: " + window.lastError()), __FILE__, __LINE__);
    return title;
  }
  QTimer answer;
  int ticks = 0;
  QObject::connect(&answer, &QTimer::timeout, [&] {
    auto* dialog = qobject_cast<QFileDialog*>(QApplication::activeModalWidget());
    if (!dialog) return;
    title = dialog->windowTitle();
    if (++ticks > 200) return dialog->reject();  // else the test would never end
    if (ticks == 1 && !dialog->nameFilters().isEmpty())
      return dialog->selectNameFilter(dialog->nameFilters().last());  // which takes it a moment
    auto* name = dialog->findChild<QLineEdit*>(QStringLiteral("fileNameEdit"));
    name->clear();
    name->setText(file);
    auto* buttons = dialog->findChild<QDialogButtonBox*>();
    QTest::mouseClick(buttons->button(file.isEmpty() ? QDialogButtonBox::Cancel : QDialogButtonBox::Open), Qt::LeftButton);
  });
  answer.start(20);
  QTest::mouseClick(button, Qt::LeftButton);
  if (ticks > 200) QTest::qFail("the dialog does not take the file", __FILE__, __LINE__);
  return title;
}

/// Presses "Allow and open" until nothing outside of the session's folder is asked for any more; how often.
int allowWhatIsOutside(MainWindow& window, const QString& session) {
  auto* bar = window.findChild<MessageBar*>(QStringLiteral("messageBar"));
  const auto button = [bar]() -> QPushButton* {
    for (QPushButton* b : bar->findChildren<QPushButton*>())
      if (bar->isVisible() && b->isVisible() && b->text() == "Allow and open") return b;
    return nullptr;
  };
  int asked = 0;
  const auto opened = [&] { return window.document().inputFile() == session && window.idle(); };
  while (QTest::qWaitFor([&] { return button() || opened(); }, 20000) && button() && asked < 5) {
    ++asked;
    const QPointer<QPushButton> pressed = button();
    QTest::mouseClick(pressed, Qt::LeftButton);
    // The answer to this question must not be counted as the next one.
    if (!QTest::qWaitFor([&] { return !pressed || !pressed->isVisible(); }, 20000)) return -1;
  }
  return asked;
}

/// The command line's --allow-outside.
Session trusted(Session session) {
  session.allowOutsidePaths = true;
  return session;
}

/// A file where only this program writes.
std::string inRecoveryFolder(const char* name) {
  QDir().mkpath(recoveryFolder());
  return (recoveryFolder() + '/' + name).toStdString();
}

void computed(MainWindow& window) {
  const Document& d = window.document();
  QTRY_VERIFY_WITH_TIMEOUT(window.idle() && d.inspection() && !d.stale(), 120000);
  QTRY_VERIFY_WITH_TIMEOUT(!window.findChild<ChangedInputs*>()->busy(), 60000);
}

/// A copy of the scene of a plane whose frames also have a depth map, a normal map and a mask.
void writeSceneWithFrameFiles(const QString& to) {
  copyFolder(QStringLiteral(GLINT_SOURCE_DIR "/sessions/plane"), to);
  QFile file(to + "/scene.json");
  QVERIFY(file.open(QIODevice::ReadWrite));
  QJsonObject json = QJsonDocument::fromJson(file.readAll()).object();
  QJsonArray frames = json["frames"].toArray();
  QImage all(640, 480, QImage::Format_Grayscale8);
  all.fill(255);
  for (const auto& [key, folder] : {std::pair("depth", "depth"), {"normals", "normals"}, {"mask", "masks"}}) {
    QVERIFY(QDir().mkpath(to + '/' + folder));
    for (int i = 0; i < frames.size(); ++i) {
      const QString name = folder + QStringLiteral("/%1.png").arg(i);
      QVERIFY(all.save(to + '/' + name));
      QJsonObject frame = frames[i].toObject();
      frame[QLatin1String(key)] = name;
      frame["depth_scale"] = 0.01;
      frames[i] = frame;
    }
  }
  json["frames"] = frames;
  file.resize(0);
  QVERIFY(file.write(QJsonDocument(json).toJson()) > 0);
}

/// What "Copy as command" copies is run by a shell and gives the errors that are on screen.
QString checkedCommand(MainWindow& window) {
  window.actions().find(QStringLiteral("export.command"))->trigger();
  const QString command = QGuiApplication::clipboard()->text();
  QProcess shell;
  shell.setWorkingDirectory(QStringLiteral("/"));
  shell.start("sh", {"-c", QString(command).replace(QStringLiteral("glint evaluate"), QStringLiteral(GLINT_CLI " evaluate")) +
                               " --json -"});
  const bool ended = shell.waitForFinished(120000) && shell.exitCode() == 0;
  if (!ended) QTest::qFail(shell.readAllStandardError().constData(), __FILE__, __LINE__);
  const QJsonObject models = QJsonDocument::fromJson(shell.readAllStandardOutput()).object()["models"].toObject();
  int compared = 0;
  for (const auto& [name, model] : window.document().inspection()->models) {
    const QJsonArray rows = models[toQString(name)].toObject()["frames"].toArray();
    for (const FrameComparison& c : model.frames)
      for (const FrameComparison::Row& shown : c.rows)
        for (const QJsonValue& row : rows) {
          if (!shown.metrics || row["index"].toInt() != c.frame || row["highlight"].toInt() != shown.observed ||
              row["light"].toString() != toQString(c.light))
            continue;
          ++compared;
          const double printed = row["contour_error_px"].toDouble(-1), is = shown.metrics->contourErrorPx;
          if (std::abs(is - printed) > 1e-9 * is)
            QTest::qFail(qPrintable(QStringLiteral("%1 %2: %3 %4").arg(toQString(name)).arg(c.frame).arg(is).arg(printed)),
                         __FILE__, __LINE__);
        }
  }
  if (compared < 3) QTest::qFail("nothing was compared", __FILE__, __LINE__);
  return command;
}
}  // namespace

class RelinkedTest : public QObject {
  Q_OBJECT
 private slots:
  void initTestCase() { QApplication::setAttribute(Qt::AA_DontUseNativeDialogs); }
  void init() { folder_ = std::make_unique<QTemporaryDir>(); }

  void theMissingMeshOfASessionIsLocatedAndRemembered() {
    const QString old = path("work/old"), found = path("work/elsewhere/another name.ply");
    copyFolder(vase(), old);
    move(old + '/' + kMesh, found);
    MainWindow window(coreEngine());
    window.show();
    window.open(old + "/vase.glint");
    QTRY_VERIFY_WITH_TIMEOUT(locateButton(window) != nullptr, 20000);
    QVERIFY2(window.lastError().contains(old + '/' + kMesh) && !window.lastError().contains('\n'),
             qPrintable(window.lastError()));
    QVERIFY(!window.document().scene());
    QCOMPARE(locate(window, {}), QStringLiteral("Where is geom_00.ply?"));  // given up
    QVERIFY(!window.document().scene());
    locate(window, found);  // it still offers
    computed(window);
    QVERIFY2(!window.findChild<MessageBar*>()->isVisible(), qPrintable(window.findChild<MessageBar*>()->text()));
    QCOMPARE(meshOf(window), found);
    QVERIFY(window.document().hasUnsavedChanges());
    const QString command = checkedCommand(window);
    QVERIFY2(command.contains("--mesh 'mesh/geom_00.ply=" + found + "'"), qPrintable(command));
    // What would be recovered after a crash knows it, too.
    const std::string left = inRecoveryFolder("mesh.glint");
    coreEngine().autosave(window.document().toSave(), left);
    const Opened recovered = openInput(left);
    QCOMPARE(toQString(recovered.scene->surfaces.at("g00").file()->file.string()), found);

    QVERIFY(window.files()->save());
    QTRY_VERIFY_WITH_TIMEOUT(window.idle() && !window.document().hasUnsavedChanges(), 60000);
    move(path("work"), path("moved"));
    const QString session = path("moved/old/vase.glint");
    const Replay replayed = replay(trusted(readSession(session.toStdString())));
    QVERIFY2(replayed.differences.empty() && replayed.compared > 0, "");
    QProcess program;
    program.start(QStringLiteral(GLINT_CLI), {"replay", session, "--allow-outside"});
    QVERIFY(program.waitForFinished(120000));
    QVERIFY2(program.exitCode() == 0, program.readAllStandardError().constData());
    window.open(session);  // at a new place it is a session like one from others
    QCOMPARE(allowWhatIsOutside(window, session), 1);
    QTRY_COMPARE_WITH_TIMEOUT(window.document().inputFile(), session, 20000);
    computed(window);
    QCOMPARE(meshOf(window), path("moved/elsewhere/another name.ply"));
    QVERIFY(!window.document().hasUnsavedChanges());
  }

  void aSceneAsksForEveryMeshThatIsNotBesideAnother() {
    const QString scene = path("scene");
    copyFolder(vase(), scene);
    QFile file(scene + "/scene.json");
    QVERIFY(file.open(QIODevice::ReadWrite));
    QByteArray text = file.readAll();
    QVERIFY(text.contains("\"g00\": {\"mesh\": \"mesh/geom_00.ply\"}"));
    text.replace(
        "\"g00\": {\"mesh\": \"mesh/geom_00.ply\"}",
        "\"g00\": {\"mesh\": \"mesh/geom_00.ply\"}, \"g01\": {\"mesh\": \"mesh/b.ply\"}, \"g02\": {\"mesh\": \"mesh/c.ply\"}");
    file.resize(0);
    file.write(text);
    file.close();
    for (const char* name : {"first/mesh/b.ply", "second/c.ply"}) {
      QDir().mkpath(QFileInfo(path(name)).path());
      QVERIFY(QFile::copy(scene + '/' + kMesh, path(name)));
    }
    move(scene + '/' + kMesh, path("first") + '/' + kMesh);
    MainWindow window(coreEngine());
    window.show();
    window.open(scene);  // the folder
    QCOMPARE(locate(window, path("first") + '/' + kMesh), QStringLiteral("Where is geom_00.ply?"));
    QCOMPARE(locate(window, path("second/c.ply")), QStringLiteral("Where is c.ply?"));  // b.ply lies beside the first
    computed(window);
    const auto& surfaces = window.document().scene()->surfaces;
    QCOMPARE(toQString(surfaces.at("g00").file()->file.string()), path("first/mesh/geom_00.ply"));
    QCOMPARE(toQString(surfaces.at("g01").file()->file.string()), path("first/mesh/b.ply"));
    QCOMPARE(toQString(surfaces.at("g02").file()->file.string()), path("second/c.ply"));
    QVERIFY(window.document().hasUnsavedChanges() && window.document().sessionFile().isEmpty());
    checkedCommand(window);
  }

  void theSceneAndThenItsMeshAreLocated() {
    const QString old = path("old"), moved = path("moved");
    copyFolder(vase(), old);
    QDir().mkpath(moved);
    for (const char* part : {"scene.json", "frames"}) move(old + '/' + part, moved + '/' + part);
    move(old + '/' + kMesh, path("meshes/geom_00.ply"));
    MainWindow window(coreEngine());
    window.show();
    window.open(old + "/vase.glint");
    QCOMPARE(locate(window, moved + "/scene.json"), QStringLiteral("Where is scene.json?"));
    QCOMPARE(locate(window, path("meshes/geom_00.ply")), QStringLiteral("Where is geom_00.ply?"));
    computed(window);
    QCOMPARE(meshOf(window), path("meshes/geom_00.ply"));
    QVERIFY2(!window.findChild<MessageBar*>()->isVisible(), qPrintable(window.findChild<MessageBar*>()->text()));
    QCOMPARE(toQString(window.document().scene()->file.string()), moved + "/scene.json");
  }

  void anotherMeshIsToldAndNoMeshIsRefused() {
    const QString old = path("old");
    copyFolder(vase(), old);
    move(old + '/' + kMesh, path("geom_00.ply"));
    QFile mesh(path("geom_00.ply"));
    QVERIFY(mesh.open(QIODevice::Append) && mesh.write("\n") == 1);  // the same mesh, but not the same file
    mesh.close();
    MainWindow window(coreEngine());
    window.show();
    window.open(QStringLiteral(GLINT_SOURCE_DIR "/sessions/plane/plane.glint"));
    QTRY_VERIFY_WITH_TIMEOUT(window.document().scene() != nullptr, 20000);
    computed(window);
    const std::shared_ptr<const Scene> before = window.document().sharedScene();
    window.open(old + "/vase.glint");
    locate(window, old + "/scene.json");
    QTRY_VERIFY_WITH_TIMEOUT(window.lastError().startsWith(old + "/scene.json: "), 20000);
    QVERIFY(window.document().sharedScene() == before && !window.document().hasUnsavedChanges());
    locate(window, path("geom_00.ply"));  // another chance
    QTRY_VERIFY_WITH_TIMEOUT(window.document().sharedScene() != before, 20000);
    computed(window);
    auto* bar = window.findChild<MessageBar*>();
    QCOMPARE(bar->text(), path("geom_00.ply") + " differs from the mesh that the session was made with");
    QVERIFY(bar->isVisible());
  }

  void aDamagedMeshIsLocatedLikeAMissingOne() {
    const QString old = path("old"), whole = path("whole.ply");
    copyFolder(vase(), old);
    QVERIFY(QFile::copy(old + '/' + kMesh, whole));
    QVERIFY(QFile::resize(old + '/' + kMesh, 5000));
    MainWindow window(coreEngine());
    window.show();
    window.open(old + "/vase.glint");
    QTRY_VERIFY_WITH_TIMEOUT(locateButton(window) != nullptr, 20000);
    QVERIFY2(window.lastError().startsWith(old + '/' + kMesh + ": "), qPrintable(window.lastError()));
    Document& d = window.document();
    QVERIFY(d.scene() && !d.inspection());
    d.setLayerVisible("rays", "Rays", !d.layerVisible("rays"));  // must not be lost
    const bool rays = d.layerVisible("rays");
    QCOMPARE(locate(window, {}), QStringLiteral("Where is geom_00.ply?"));  // given up
    locate(window, old + "/scene.json");                                    // it still offers, but this is no mesh
    QTRY_VERIFY_WITH_TIMEOUT(window.lastError().startsWith(old + "/scene.json: "), 20000);
    locate(window, whole);  // another chance
    QTRY_COMPARE_WITH_TIMEOUT(meshOf(window), whole, 20000);
    computed(window);
    QVERIFY2(!window.findChild<MessageBar*>()->isVisible(), qPrintable(window.findChild<MessageBar*>()->text()));
    QVERIFY(d.hasUnsavedChanges() && d.layerVisible("rays") == rays);
    QVERIFY(window.findChild<ChangedInputs*>()->all().isEmpty());
    QVERIFY(window.files()->save());
    QTRY_VERIFY_WITH_TIMEOUT(window.idle() && !d.hasUnsavedChanges(), 60000);
    const Session session = readSession((old + "/vase.glint").toStdString());
    QCOMPARE(toQString(session.meshes.at(kMesh.toStdString()).string()), whole);
    const Replay replayed = replay(trusted(session));
    QVERIFY2(replayed.differences.empty() && replayed.compared > 0, "");
  }

  void depthMapsNormalMapsAndMasksAreLocatedAndRemembered() {
    const QString scene = path("work/scene");
    writeSceneWithFrameFiles(scene);
    MainWindow window(coreEngine());
    window.show();
    window.open(scene + "/scene.json");
    QTRY_VERIFY_WITH_TIMEOUT(window.document().scene() != nullptr, 20000);
    computed(window);
    InspectionRequest request = window.document().request();
    request.train = "0-3";
    window.document().setRequest(request, QStringLiteral("Hold out two"));
    computed(window);
    auto* unreadable = window.findChild<UnreadableFiles*>();
    for (const FrameFile kind : kFrameFiles) QVERIFY(unreadable->all(kind).isEmpty());
    coreEngine().save(window.document().toSave(), window.document().inspection().get(), (scene + "/own.glint").toStdString(), {});
    const std::string inPlace = digestOf(*window.document().inspection());
    window.document().undoStack()->undo();  // nothing is unsaved
    for (const char* kind : {"depth", "masks"}) move(scene + '/' + kind, path("work/elsewhere/") + kind);
    move(scene + "/normals", path("work/third"));

    window.open(scene + "/own.glint");
    QTRY_VERIFY_WITH_TIMEOUT(!window.document().sessionFile().isEmpty(), 20000);
    computed(window);
    auto* bar = window.findChild<MessageBar*>();
    QTRY_VERIFY2_WITH_TIMEOUT(bar->text().startsWith("Cannot read 6 depth maps, 6 normal maps and 6 masks: depth/0.png: "),
                              qPrintable(bar->text()), 20000);
    QVERIFY(unreadable->all().isEmpty());
    QVERIFY2(window.findChild<Timeline*>()->strip()->unreadable().isEmpty(), "the photographs are there");
    QCOMPARE(locate(window, path("work/elsewhere")), QStringLiteral("Where are the depth maps, normal maps and masks?"));
    QTRY_VERIFY2_WITH_TIMEOUT(bar->text().startsWith("Cannot read 6 normal maps: "), qPrintable(bar->text()), 60000);
    computed(window);
    QCOMPARE(locate(window, path("work/third")), QStringLiteral("Where are the normal maps?"));
    QTRY_VERIFY_WITH_TIMEOUT(!bar->isVisible() && window.idle() && unreadable->all(FrameFile::Normals).isEmpty(), 60000);
    computed(window);
    QVERIFY(window.document().hasUnsavedChanges());
    QCOMPARE(digestOf(*window.document().inspection()), inPlace);
    const QString command = checkedCommand(window);
    for (const QString& part :
         {"depth=" + path("work/elsewhere"), "normals=" + path("work/third"), "masks=" + path("work/elsewhere")})
      QVERIFY2(command.contains(" --files " + part), qPrintable(command));
    // What would be recovered after a crash knows them, too.
    const std::string left = inRecoveryFolder("folders.glint");
    coreEngine().autosave(window.document().toSave(), left);
    QCOMPARE(openInput(left).scene->folders, window.document().scene()->folders);

    QVERIFY(window.files()->save());
    QTRY_VERIFY_WITH_TIMEOUT(window.idle() && !window.document().hasUnsavedChanges(), 60000);
    move(path("work"), path("moved"));
    const QString session = path("moved/scene/own.glint");
    QProcess program;
    program.start(QStringLiteral(GLINT_CLI), {"replay", "--exact", session, "--allow-outside"});
    QVERIFY(program.waitForFinished(120000));
    QVERIFY2(program.exitCode() == 0, program.readAllStandardError().constData());
    window.open(session);
    QCOMPARE(allowWhatIsOutside(window, session), 2);  // for each folder, not for each file
    QTRY_COMPARE_WITH_TIMEOUT(window.document().sessionFile(), session, 20000);
    computed(window);
    for (const FrameFile kind : kFrameFiles) QVERIFY(unreadable->all(kind).isEmpty());
    QVERIFY(!bar->isVisible() && !window.document().hasUnsavedChanges());
    QCOMPARE(toQString(window.document().scene()->frames[0].mask.string()), path("moved/elsewhere/masks/0.png"));
    QCOMPARE(toQString(window.document().scene()->frames[0].normals.string()), path("moved/third/0.png"));
  }

  void whatCouldBeOfTwoKindsIsAsked() {
    const QString scene = path("scene"), elsewhere = path("elsewhere");
    writeSceneWithFrameFiles(scene);
    QVERIFY(QDir().mkpath(elsewhere));
    for (const char* kind : {"normals", "masks"}) {
      move(scene + '/' + kind + "/3.png", path("was-") + kind + "/3.png");
      QVERIFY(QFile::copy(path("was-") + kind + "/3.png", elsewhere + "/3.png") || QFile::exists(elsewhere + "/3.png"));
    }
    MainWindow window(coreEngine());
    window.show();
    window.open(scene + "/scene.json");
    QTRY_VERIFY_WITH_TIMEOUT(window.document().scene() != nullptr, 20000);
    computed(window);
    auto* bar = window.findChild<MessageBar*>();
    QTRY_VERIFY2_WITH_TIMEOUT(bar->text().startsWith("Cannot read 1 normal map and 1 mask: normals/3.png: "),
                              qPrintable(bar->text()), 20000);
    locate(window, elsewhere);
    QMessageBox* question = nullptr;
    QTRY_VERIFY_WITH_TIMEOUT((question = window.findChild<QMessageBox*>(QStringLiteral("whichFiles"))) != nullptr, 20000);
    QVERIFY2(question->text().contains("normal maps or masks"), qPrintable(question->text()));
    for (QAbstractButton* button : question->buttons())
      if (button->text() == QStringLiteral("Masks")) QTest::mouseClick(button, Qt::LeftButton);
    QTRY_COMPARE_WITH_TIMEOUT(toQString(window.document().scene()->frames[3].mask.string()), elsewhere + "/3.png", 20000);
    computed(window);
    QTRY_VERIFY2_WITH_TIMEOUT(bar->text().startsWith("Cannot read 1 normal map: "), qPrintable(bar->text()), 20000);
    // The normal map does not take the same file.
    locate(window, elsewhere);
    QTRY_VERIFY2_WITH_TIMEOUT(window.lastError().endsWith("contains no normal maps of this scene"),
                              qPrintable(window.lastError()), 20000);
  }

  void theCommandNamesWherePhotographsAre() {
    const QString scene = path("scene"), elsewhere = path("else where");
    copyFolder(QStringLiteral(GLINT_SOURCE_DIR "/sessions/plane"), scene);
    MainWindow window(coreEngine());
    window.show();
    window.open(scene + "/plane.glint");
    QTRY_VERIFY_WITH_TIMEOUT(window.document().scene() != nullptr, 20000);
    computed(window);
    const QString usual = checkedCommand(window);
    QVERIFY2(!usual.contains("--photographs") && !usual.contains("--mesh"), qPrintable(usual));
    move(scene + "/frames", elsewhere);
    QTRY_VERIFY(window.idle());
    window.open(scene + "/plane.glint");
    auto* unreadable = window.findChild<UnreadableFiles*>();
    QTRY_VERIFY_WITH_TIMEOUT(window.idle() && !unreadable->all().isEmpty(), 60000);
    unreadable->locateIn(elsewhere);
    QTRY_VERIFY_WITH_TIMEOUT(window.idle() && unreadable->all().isEmpty(), 60000);
    computed(window);
    QCOMPARE(checkedCommand(window), usual + " --photographs '" + elsewhere + "'");
  }

 private:
  static QString vase() { return QStringLiteral(GLINT_SOURCE_DIR "/sessions/vase"); }
  QString path(const QString& name) const { return folder_->filePath(name); }
  static QString meshOf(MainWindow& window) {
    return toQString(window.document().scene()->surfaces.at("g00").file()->file.string());
  }
  std::unique_ptr<QTemporaryDir> folder_;
};

QObject* makeRelinkedTest() { return new RelinkedTest; }

}  // namespace glint::gui

#include "relinked_test.moc"
