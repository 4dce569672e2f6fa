// SPDX-License-Identifier: BSD-3-Clause
// Photographs that are missing or damaged: named in one place, marked in the timeline, found again in another folder.
#include <QAction>
#include <QDialog>
#include <QDir>
#include <QDirIterator>
#include <QFile>
#include <QHelpEvent>
#include <QPlainTextEdit>
#include <QPushButton>
#include <QToolTip>
#include <QTreeWidget>

#include "core/app/session.h"
#include "gui/base/theme.h"
#include "gui/timeline/timeline.h"
#include "gui/window/changed_inputs.h"
#include "gui/window/file_actions.h"
#include "gui/window/main_window.h"
#include "gui/window/message_bar.h"
#include "gui/window/unreadable_files.h"
#include "tests/gui/fixture.h"

namespace glint::gui {

class UnreadableTest : public QObject {
  Q_OBJECT
 private slots:
  void areNamedMarkedListedAndFoundElsewhere() {
    const QString scene = folder_.filePath("scene"), elsewhere = folder_.filePath("elsewhere");
    QDir().mkpath(scene + "/frames");
    QDir().mkpath(elsewhere);
    const QDir shipped(QStringLiteral(GLINT_SOURCE_DIR "/sessions/plane"));
    for (const QString& name : {QStringLiteral("scene.json"), QStringLiteral("plane.glint")})
      QVERIFY(QFile::copy(shipped.filePath(name), scene + "/" + name));
    for (const QString& name : QDir(shipped.filePath("frames")).entryList(QDir::Files))
      QVERIFY(QFile::copy(shipped.filePath("frames/" + name), scene + "/frames/" + name));
    QVERIFY(QFile::rename(scene + "/frames/0002.png", elsewhere + "/0002.png"));
    QFile cut(scene + "/frames/0004.png");
    cut.setPermissions(QFile::ReadOwner | QFile::WriteOwner);
    QVERIFY(QFile::copy(cut.fileName(), elsewhere + "/0004.png"));
    QVERIFY(cut.resize(2000));

    MainWindow window(coreEngine());
    window.show();
    QAction* list = window.actions().find(QStringLiteral("file.unreadable-photographs"));
    QVERIFY(list && !list->isEnabled());
    window.open(scene + "/plane.glint");
    Document& d = window.document();
    QTRY_VERIFY_WITH_TIMEOUT(d.inspection() && window.idle(), 60000);
    auto* unreadable = window.findChild<UnreadableFiles*>();
    QCOMPARE(unreadable->all().keys(), (QList<int>{2, 4}));
    QVERIFY2(unreadable->all()[2].startsWith("frames/0002.png: ") && unreadable->all()[2].contains("No such file"),
             qPrintable(unreadable->all()[2]));
    QCOMPARE(unreadable->all()[4], QStringLiteral("frames/0004.png: the PNG is truncated"));
    auto* bar = window.findChild<MessageBar*>();
    QVERIFY(bar->isVisible());
    for (const char* part : {"2 photographs", "frames/0002.png", "frames/0004.png: the PNG is truncated"})
      QVERIFY2(bar->text().contains(part), qPrintable(bar->text()));
    TimelineStrip* strip = window.findChild<Timeline*>()->strip();
    QCOMPARE(strip->unreadable(), (QList<int>{2, 4}));
    // A mark under the thumbnails and a cross in place of them are drawn; the tool tip says why.
    const auto warnedAt = [&](int frame) {
      const QImage shown = strip->grab().toImage();
      const double ratio = shown.devicePixelRatio(), wide = (strip->width() - 56 - 10) / strip->framesInView();
      const int from = int(56 + (frame - strip->firstFrame()) * wide), to = int(from + wide);
      std::pair<int, int> n{0, 0};  // in the upper third, where thumbnails are; below it
      for (int y = 0; y < shown.height(); ++y)
        for (int x = int(from * ratio); x < to * ratio; ++x)
          if (shown.pixelColor(x, y).rgb() == warningColour().rgb()) ++(y < 40 * ratio ? n.first : n.second);
      return n;
    };
    d.selectFrame(0);  // the first held-out frame, which is shown first, is tinted
    for (const int frame : {2, 4}) {
      const auto [cross, mark] = warnedAt(frame);
      QVERIFY2(cross > 20 && mark > 15, qPrintable(QStringLiteral("%1 %2").arg(cross).arg(mark)));
    }
    QCOMPARE(warnedAt(3), std::pair(0, 0));
    const int middleOf4 = int(56 + 4.5 * (strip->width() - 56 - 10) / strip->framesInView());
    QHelpEvent help(QEvent::ToolTip, {middleOf4, 20}, strip->mapToGlobal(QPoint(middleOf4, 20)));
    QCoreApplication::sendEvent(strip, &help);
    QTRY_VERIFY2(QToolTip::text().contains("no photograph: frames/0004.png: the PNG is truncated"), qPrintable(QToolTip::text()));
    QToolTip::hideText();

    QVERIFY(list->isEnabled());
    list->trigger();
    auto* dialog = window.findChild<QDialog*>(QStringLiteral("unreadableFiles"));
    QVERIFY(dialog && dialog->isVisible());
    auto* rows = dialog->findChild<QTreeWidget*>();
    QCOMPARE(rows->topLevelItemCount(), 2);
    QTest::mouseClick(rows->viewport(), Qt::LeftButton, {}, rows->visualItemRect(rows->topLevelItem(1)).center());
    QCOMPARE(d.selection().frame, 4);

    const std::shared_ptr<const Scene> before = d.sharedScene();
    unreadable->locateIn(folder_.path());  // holds no such file at its top
    QTRY_VERIFY_WITH_TIMEOUT(!window.lastError().isEmpty(), 10000);
    QVERIFY(d.sharedScene() == before);
    d.setLayerVisible("rays", "Rays", true);  // stays, although it was not saved
    unreadable->locateIn(elsewhere);
    QTRY_VERIFY_WITH_TIMEOUT(d.sharedScene() != before && d.inspection() && window.idle(), 60000);
    QVERIFY(unreadable->all().isEmpty());
    QVERIFY(!list->isEnabled());
    QVERIFY(!bar->isVisible());
    QCOMPARE(d.selection().frame, 4);
    QVERIFY(d.layerVisible("rays") && d.hasUnsavedChanges());
    for (const int frame : {2, 4}) QVERIFY(!d.inspection()->evidence[std::size_t(frame)].failure);

    // The session remembers the place, relative to itself.
    QVERIFY(window.files()->save());
    QTRY_VERIFY_WITH_TIMEOUT(window.idle() && !d.hasUnsavedChanges(), 60000);
    const auto trusted = [](const QString& file) {  // as with --allow-outside
      Session session = readSession(file.toStdString());
      session.allowOutsidePaths = true;
      return session;
    };
    const OpenedSession again = openSession(trusted(scene + "/plane.glint"));
    QCOMPARE(QString::fromStdString(again.scene->frames[2].image.string()), elsewhere + "/0002.png");
    QFile saved(scene + "/plane.glint");
    QVERIFY(saved.open(QIODevice::ReadOnly));
    const QByteArray text = saved.readAll();
    QVERIFY2(text.contains("\"of\": \"photographs\"") && text.contains("\"folder\": \"../elsewhere\""), text.constData());
    saved.close();
    QVERIFY(QDir().rename(folder_.filePath("scene"), folder_.filePath("moved")));
    const Replay replayed = replay(trusted(folder_.filePath("moved/plane.glint")));
    QVERIFY2(replayed.differences.empty(), replayed.differences.empty() ? "" : replayed.differences.front().c_str());
  }

  void inputsThatChangedSinceTheSessionWasSavedAreSaid() {
    const QString scene = folder_.filePath("changed");
    copyFolder(QStringLiteral(GLINT_SOURCE_DIR "/sessions/plane"), scene);
    const auto append = [](const QString& name) {  // ends what both kinds of file hold: they are read as before
      QFile file(name);
      file.setPermissions(QFile::ReadOwner | QFile::WriteOwner);
      return file.open(QIODevice::Append) && file.write("\n") == 1;
    };
    QVERIFY(append(scene + "/scene.json") && append(scene + "/frames/0002.png"));
    QVERIFY(QFile::remove(scene + "/frames/0003.png"));  // said as one that cannot be read
    MainWindow window(coreEngine());
    window.show();
    window.open(scene + "/plane.glint");
    auto* changed = window.findChild<ChangedInputs*>();
    QTRY_VERIFY_WITH_TIMEOUT(window.document().inspection() && window.idle() && !changed->busy(), 60000);
    QCOMPARE(changed->all(), (QStringList{"scene.json: changed", "frames/0002.png: changed"}));
    QString log;
    for (const QPlainTextEdit* edit : window.findChildren<QPlainTextEdit*>()) log += edit->toPlainText();
    for (const QString& line : changed->all()) QVERIFY2(log.contains("Since this session was saved: " + line), qPrintable(log));
    auto* bar = window.findChild<MessageBar*>();
    QVERIFY2(bar->isVisible() && bar->text().contains("frames/0003.png"), "what cannot be read is more urgent");
    QVERIFY(QFile::copy(QStringLiteral(GLINT_SOURCE_DIR "/sessions/plane/frames/0003.png"), scene + "/frames/0003.png"));
    bar->hide();
    window.open(scene + "/plane.glint");
    QTRY_VERIFY_WITH_TIMEOUT(bar->isVisible(), 60000);
    QVERIFY2(bar->text().contains("scene.json: changed") && bar->text().contains("frames/0002.png"), qPrintable(bar->text()));
    QTRY_VERIFY_WITH_TIMEOUT(window.idle() && !changed->busy(), 60000);
  }

  /// Contours that came with the scene are not looked for in photographs: the pipeline does not notice that one is missing.
  void whatThePipelineDoesNotReadIsFoundToo() {
    const Fixture fixture;
    Opened opened = fixture.opened();
    auto scene = std::make_shared<Scene>(*opened.scene);
    Highlight given;
    given.light = "lamp";
    given.contour.points = {{50, 50}, {60, 50}, {60, 60}};
    for (const int frame : {3, 5}) scene->frames[std::size_t(frame)].highlights = {given};
    scene->frames[3].image = scene->folder / "gone.png";
    scene->frames[5].image.clear();  // none is named, which is no fault
    scene->frames[7].image = scene->folder / "gone7.png";
    opened.scene = scene;
    Engine engine = fixture.engine();
    engine.open = [opened](const std::string& path, const Relinked&) {
      if (path != opened.path) throw InputError(path, "", "no such file");
      return opened;
    };
    MainWindow window(engine);
    window.show();
    window.open(QString::fromStdString(opened.path));
    QTRY_VERIFY_WITH_TIMEOUT(window.document().inspection() && window.idle(), 20000);
    auto* unreadable = window.findChild<UnreadableFiles*>();
    QCOMPARE(unreadable->all().keys(), QList<int>{3});
    // The stand-in for the pipeline claims to have read all others; the frame view knows better, and leaves other messages alone.
    window.open(QStringLiteral("nowhere.json"));
    auto* bar = window.findChild<MessageBar*>();
    QTRY_VERIFY(window.idle() && bar->text().contains("nowhere.json"));
    window.document().selectFrame(5);
    QTRY_VERIFY(window.idle());
    window.document().selectFrame(7);
    QTRY_COMPARE(unreadable->all().keys(), (QList<int>{3, 7}));
    QVERIFY2(bar->text().contains("nowhere.json"), qPrintable(bar->text()));
  }

  void aSceneWithAllItsPhotographsSaysNothing() {
    MainWindow window(coreEngine());
    window.show();
    window.open(QStringLiteral(GLINT_SOURCE_DIR "/sessions/plane/plane.glint"));
    QTRY_VERIFY_WITH_TIMEOUT(window.document().inspection() && window.idle(), 60000);
    QVERIFY(window.findChild<UnreadableFiles*>()->all().isEmpty());
    QTRY_VERIFY_WITH_TIMEOUT(!window.findChild<ChangedInputs*>()->busy(), 60000);
    QVERIFY(window.findChild<ChangedInputs*>()->all().isEmpty());
    QVERIFY(!window.findChild<MessageBar*>()->isVisible());
  }

 private:
  static void copyFolder(const QString& from, const QString& to) {
    QDirIterator files(from, QDir::Files, QDirIterator::Subdirectories);
    while (files.hasNext()) {
      const QString name = files.next(), there = to + '/' + QDir(from).relativeFilePath(name);
      QVERIFY(QDir().mkpath(QFileInfo(there).path()) && QFile::copy(name, there));
    }
  }

  QTemporaryDir folder_;
};

QObject* makeUnreadableTest() { return new UnreadableTest; }

}  // namespace glint::gui

#include "unreadable_test.moc"
