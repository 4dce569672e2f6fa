// SPDX-License-Identifier: BSD-3-Clause
// Shipped sessions and rendered sequences in the real window with the real pipeline.
#include "core/app/session.h"

#include <QAction>
#include <QElapsedTimer>
#include <QFile>
#include <QFileInfo>
#include <QProcess>
#include <QStatusBar>
#include <QTimer>
#include <algorithm>

#include "gui/base/text.h"
#include "gui/document/session_file.h"
#include "gui/scene/scene_options.h"
#include "gui/scene/scene_panel.h"
#include "gui/scene/scene_views.h"
#include "gui/window/main_window.h"
#include "gui/window/message_bar.h"
#include "tests/gui/fixture.h"

namespace glint::gui {

namespace {
/// The longest time for which the event loop of this thread did not turn.
class Heartbeat {
 public:
  Heartbeat() {
    QObject::connect(&timer_, &QTimer::timeout, [this] { beat(); });
    clock_.start();
    timer_.start(2);
  }
  void beat() { worst_ = std::max(worst_, clock_.restart()); }
  qint64 takeWorst() {
    beat();
    return std::exchange(worst_, 0);
  }

 private:
  QTimer timer_;
  QElapsedTimer clock_;
  qint64 worst_ = 0;
};
}  // namespace

class SessionTest : public QObject {
  Q_OBJECT
 private slots:
  /// What a model predicts is seen at once, unless a session remembers another frame.
  void aHeldOutFrameIsShownFirst() {
    const QTemporaryDir copy;  // what is written beside a session is not to lie in the sources
    std::filesystem::copy(GLINT_SOURCE_DIR "/sessions/vase", copy.path().toStdString(), std::filesystem::copy_options::recursive);
    Opened opened = openInput(copy.filePath(QStringLiteral("scene.json")).toStdString(), {});
    const std::vector<int> train = parseTrainSpec(opened.request.train, *opened.scene).frames;
    QCOMPARE(opened.selection.frame, int(train.size()));  // "first:6"
    opened.selection.frame = 1;
    const std::string file = copy.filePath(QStringLiteral("looked-at.glint")).toStdString();
    coreEngine().save(opened, nullptr, file, {});
    QCOMPARE(openInput(file, {}).selection.frame, 1);
  }

  void aSavedSessionReplaysAndComesBack() {
    const QString file = folder_.filePath(QStringLiteral("plane.glint"));
    const Engine engine = coreEngine();
    engine.save(engine.open(GLINT_SOURCE_DIR "/sessions/plane/plane.glint", {}), nullptr, file.toStdString(), {});
    const viz::ViewPoint seen{{1.5, -2, 3}, {0, 0, 0.1}, {0, 0, 1}, 25};
    viz::ViewPoint saved;
    {
      MainWindow window(engine);
      openAndWait(window, file);
      Document& document = window.document();
      auto* scene = window.findChild<ScenePanel*>();
      scene->view().setViewPoint(seen);
      saved = scene->view().viewPoint();
      document.setLayerVisible("rays", "Rays", !document.layerVisible("rays"));
      document.setLayerVisible("frame/peak", "Peaks", false);
      document.select({1, "canonical", 0});
      QVERIFY(!document.hasUnsavedChanges());  // looked at otherwise: saved along
      document.setSetting("detect.level", 0.4);
      QVERIFY(document.hasUnsavedChanges());
      QTRY_VERIFY_WITH_TIMEOUT(window.idle() && !document.stale(), 60000);
      save(window);
      QVERIFY(window.runner().busy());  // not on this thread
      QTRY_VERIFY_WITH_TIMEOUT(window.idle(), 60000);
      QVERIFY2(window.lastError().isEmpty(), qPrintable(window.lastError()));
      QVERIFY(!document.hasUnsavedChanges());
      QTRY_VERIFY(window.statusBar()->currentMessage().contains(file));  // it is shown when the event loop comes to it
    }
    QProcess replay;
    replay.start(QStringLiteral(GLINT_CLI), {QStringLiteral("replay"), file, QStringLiteral("--exact")});
    QVERIFY(replay.waitForFinished(180000));
    QVERIFY2(replay.exitCode() == 0, replay.readAllStandardError().constData());
    MainWindow window(engine);
    openAndWait(window, file);
    const Document& document = window.document();
    const viz::ViewPoint back = window.findChild<ScenePanel*>()->view().viewPoint();
    QVERIFY((back.position - saved.position).norm() < 1e-12 && (back.focalPoint - saved.focalPoint).norm() < 1e-12);
    QVERIFY((back.up - saved.up).norm() < 1e-12 && std::abs(back.viewAngleDeg - saved.viewAngleDeg) < 1e-12);
    QCOMPARE(document.selection().frame, 1);
    QCOMPARE(document.selection().model, std::string("canonical"));
    QCOMPARE(document.layerVisible("frame/peak"), false);
    QVERIFY(document.state().layers.count("rays"));
  }

  void everyUnlinkedViewComesBackWithItsOwnCamera() {
    const QString file = folder_.filePath(QStringLiteral("four.glint"));
    const Engine engine = coreEngine();
    Opened opened = engine.open(GLINT_SOURCE_DIR "/sessions/plane/plane.glint", {});
    opened.options["scene/views"] = "4";
    opened.options["scene/linked"] = "0";
    opened.viewPoints = {{{1, -2, 3}, {0, 0, 0.1}, {0, 1, 0}, 25}};
    engine.save(opened, nullptr, file.toStdString(), {});
    const auto seen = [](MainWindow& window) { return window.findChild<ScenePanel*>()->viewPoints(); };
    const auto same = [](const std::vector<viz::ViewPoint>& a, const std::vector<viz::ViewPoint>& b) {
      constexpr double kRounding = 1e-12;  // a camera normalises its directions again
      return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const viz::ViewPoint& x, const viz::ViewPoint& y) {
        return (x.position - y.position).norm() < kRounding && (x.focalPoint - y.focalPoint).norm() < kRounding &&
               (x.up - y.up).norm() < kRounding && std::abs(x.viewAngleDeg - y.viewAngleDeg) < kRounding;
      });
    };
    std::vector<viz::ViewPoint> saved;
    {
      MainWindow window(engine);
      openAndWait(window, file);
      auto* scene = window.findChild<ScenePanel*>();
      QCOMPARE(scene->views().viewCount(), 4);
      // The file has one camera, as those of older programs: for all.
      QVERIFY(same(seen(window), std::vector(4, seen(window)[0])));
      for (int i = 0; i < 4; ++i) scene->views().view(i).setViewPoint({{1.5, -2, 1.0 + i}, {0, 0, 0.1}, {0, 1, 0}, 20.0 + i});
      saved = seen(window);
      save(window);
      QTRY_VERIFY_WITH_TIMEOUT(window.idle(), 60000);
    }
    MainWindow window(engine);
    openAndWait(window, file);
    QVERIFY(same(seen(window), saved));
    // One view is large for a moment: the others come back where the session had them.
    Actions& actions = window.actions();
    actions.find(QStringLiteral("view.views-1"))->trigger();
    QTRY_VERIFY(window.idle());
    QCOMPARE(seen(window).size(), std::size_t(1));
    actions.find(QStringLiteral("view.views-4"))->trigger();
    QTRY_VERIFY(window.idle());
    QVERIFY(same(seen(window), saved));
    actions.find(QStringLiteral("view.link-views"))->trigger();
    QTRY_VERIFY(window.idle());
    QCOMPARE(seen(window).size(), std::size_t(1));  // linked ones have one camera
  }

  void keptViewsAreCamerasOfTheFile() {
    const QString file = folder_.filePath(QStringLiteral("views.glint"));
    const Engine engine = coreEngine();
    Opened opened = engine.open(GLINT_SOURCE_DIR "/sessions/plane/plane.glint", {});
    const viz::ViewPoint top{{0.1, 0.2, 3}, {0.1, 0.2, 0}, {0, 1, 0}, 30, true}, side{{2, 1, 0.3}, {0, 0, 0.1}, {0, 0, 1}, 24};
    opened.options = {{std::string(kSavedView) + "Top", toText(top)},
                      {std::string(kSavedView) + "Side", toText(side)},
                      {std::string(kSavedView) + "Forgotten", ""},
                      {"scene/solo", "1"}};
    engine.save(opened, nullptr, file.toStdString(), {});
    const Session stored = readSession(file.toStdString());
    QVERIFY((stored.view.options == std::map<std::string, std::string>{{"scene/solo", "1"}}));
    QCOMPARE(int(stored.view.cameras.count("Forgotten")), 0);
    QVERIFY(stored.view.cameras.at("Top").parallel && !stored.view.cameras.at("Side").parallel);
    QCOMPARE(stored.view.cameras.at("Side").viewAngleDeg, 24.0);
    opened.options.erase(std::string(kSavedView) + "Forgotten");
    QVERIFY(engine.open(file.toStdString(), {}).options == opened.options);
  }

  /// Saving before there are results must not replace the stored 3D camera by that of an empty view.
  void savingWithoutResultsKeepsTheCamera() {
    const QString file = folder_.filePath(QStringLiteral("kept.glint"));
    const Engine real = coreEngine();
    Opened opened = real.open(GLINT_SOURCE_DIR "/sessions/plane/plane.glint", {});
    opened.viewPoints = {{{1, 2, 3}, {0, 0, 0}, {0, 1, 0}, 20}, {{3, 2, 1}, {0, 0, 0}, {0, 1, 0}, 20}};
    real.save(opened, nullptr, file.toStdString(), {});
    Engine engine = real;
    engine.ask = [](Pipeline&, const Question&, const ProgressFn&) -> Pipeline::Answer { throw Stopped{}; };
    MainWindow window(engine);
    window.show();
    window.open(file);
    QTRY_VERIFY(window.document().scene() && window.idle());
    save(window);
    QTRY_VERIFY(window.idle());
    const Opened back = real.open(file.toStdString(), {});
    QCOMPARE(int(back.viewPoints.size()), 2);
    QVERIFY(back.viewPoints[0].position == Eigen::Vector3d(1, 2, 3) && back.viewPoints[1].position == Eigen::Vector3d(3, 2, 1));
    QTRY_VERIFY(window.statusBar()->currentMessage().contains("without results"));
  }

  void newerAndDamagedSessionsAreAMessageAndWhatIsOpenStays() {
    MainWindow window(coreEngine());
    openAndWait(window, QStringLiteral(GLINT_SOURCE_DIR "/sessions/plane/plane.glint"));
    QFile shipped(QStringLiteral(GLINT_SOURCE_DIR "/sessions/plane/plane.glint"));
    QVERIFY(shipped.open(QIODevice::ReadOnly));
    const QByteArray text = shipped.readAll();
    const std::pair<QByteArray, QString> cases[] = {
        {QByteArray(text).replace("\"glint_session\": 3", "\"glint_session\": 9"), QStringLiteral("newer than this program")},
        {text.left(text.size() / 2), QStringLiteral("bad.glint")}};
    auto* bar = window.findChild<MessageBar*>(QStringLiteral("messageBar"));
    for (const auto& [content, expected] : cases) {
      QFile file(folder_.filePath(QStringLiteral("bad.glint")));
      QVERIFY(file.open(QIODevice::WriteOnly));
      file.write(content);
      file.close();
      const std::shared_ptr<const Scene> before = window.document().sharedScene();
      window.open(file.fileName());
      QTRY_VERIFY(window.idle());
      QVERIFY2(bar->isVisible() && bar->text().contains(expected), qPrintable(bar->text()));
      QVERIFY(window.document().sharedScene() == before);
      QVERIFY(!window.document().stale());
    }
  }

  void aFileThatCannotBeWrittenIsAMessageAndNothingIsLost() {
    MainWindow window(coreEngine());
    openAndWait(window, QStringLiteral(GLINT_SOURCE_DIR "/sessions/plane/plane.glint"));
    QSignalSpy saved(&window.runner(), &Runner::saved);
    auto opened = std::make_shared<const Opened>(window.document().toSave());
    window.document().setSetting("detect.level", 0.4);
    window.runner().save(opened, window.document().inspection(), "/nowhere/x.glint");
    QVERIFY(saved.wait(60000));
    QVERIFY2(saved[0][1].toString().contains("/nowhere/x.glint"), qPrintable(saved[0][1].toString()));
    QVERIFY(window.document().hasUnsavedChanges());
    QVERIFY(!QFileInfo::exists(QStringLiteral("/nowhere")));
  }

  /// Prints how soon a run on 60 rendered frames ends after Stop, and how long the interface stood still meanwhile.
  void stopAndInterfaceOnAWholeSequence() {
    const QString scene = QStringLiteral(GLINT_SHARED_DIR "/data/cycles/plane_to_cylinder/scene.json");
    if (!QFileInfo::exists(scene)) QSKIP("the rendered sequences are not here");
    MainWindow window(coreEngine());
    window.show();
    QVERIFY(QTest::qWaitForWindowExposed(&window));
    QSignalSpy progressed(&window.runner(), &Runner::progressed), stopped(&window.runner(), &Runner::stopped);
    Heartbeat heart;
    window.open(scene);
    QTRY_VERIFY_WITH_TIMEOUT(window.document().scene() && progressed.count() > 3, 60000);
    qInfo("opening: the interface stood still for at most %lld ms", static_cast<long long>(heart.takeWorst()));
    QElapsedTimer clock;
    clock.start();
    window.runner().cancel();
    QVERIFY(stopped.wait(60000));
    qInfo("stopped while detecting after %lld ms", static_cast<long long>(clock.elapsed()));
    // Stops in every part of a run: the level changes, so that nothing is reused.
    int n = 0;
    for (const int delayMs : {50, 200, 500, 1000, 1500}) {
      window.document().setSetting("detect.level", 0.5 + 0.01 * ++n);
      QTest::qWait(delayMs);
      const QString stage = progressed.isEmpty() ? QStringLiteral("start") : progressed.last()[0].toString();
      const bool ran = window.runner().busy();
      clock.restart();
      window.runner().cancel();
      QTRY_VERIFY_WITH_TIMEOUT(!window.runner().busy(), 60000);
      qInfo("%d ms into a run (%s, %s): stopped after %lld ms", delayMs, qPrintable(stage), ran ? "running" : "already done",
            static_cast<long long>(clock.elapsed()));
    }
    heart.takeWorst();
    window.document().setSetting("detect.level", 0.5);
    QTRY_VERIFY_WITH_TIMEOUT(!window.document().stale(), 300000);
    qInfo("computing: the interface stood still for at most %lld ms", static_cast<long long>(heart.takeWorst()));
    QTRY_VERIFY_WITH_TIMEOUT(window.idle(), 60000);
    QTest::qWait(300);
    qInfo("showing the first results: at most %lld ms", static_cast<long long>(heart.takeWorst()));
    window.document().selectFrame(30);
    QTest::qWait(500);
    qInfo("another frame: at most %lld ms", static_cast<long long>(heart.takeWorst()));
  }

 private:
  /// Uses the menu's action: without a window manager no window is active, and shortcuts need an active one.
  static void save(MainWindow& window) {
    for (QAction* action : window.findChildren<QAction*>())
      if (action->shortcut() == QKeySequence(QKeySequence::Save)) action->trigger();
  }
  static void openAndWait(MainWindow& window, const QString& file) {
    window.show();
    QVERIFY(QTest::qWaitForWindowExposed(&window));
    window.open(file);
    QTRY_VERIFY_WITH_TIMEOUT(window.document().scene() && window.idle() && !window.document().stale(), 120000);
    QTest::qWait(50);
  }
  QTemporaryDir folder_;
};

QObject* makeSessionTest() { return new SessionTest; }

}  // namespace glint::gui

#include "session_test.moc"
