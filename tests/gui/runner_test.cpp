// SPDX-License-Identifier: BSD-3-Clause
#include "gui/document/runner.h"

#include <QSignalSpy>
#include <atomic>

#include "gui/base/text.h"
#include "gui/panels/log_panel.h"
#include "gui/window/main_window.h"
#include "tests/gui/fixture.h"

namespace glint::gui {

class RunnerTest : public QObject {
  Q_OBJECT
 private slots:
  void finishedCarriesTheResultAndItsRequest() {
    Runner runner(fixture_.engine());
    QSignalSpy finished(&runner, &Runner::finished);
    InspectionRequest request;
    request.train = "0-3";
    runner.inspect(pipeline_, request);
    QVERIFY(runner.busy());
    QVERIFY(finished.wait());
    QCOMPARE(finished[0][0].value<InspectionPtr>()->train.frames, (std::vector<int>{0, 1, 2, 3}));
    QCOMPARE(finished[0][1].value<OpenedPtr>()->request.train, std::string("0-3"));
    QTRY_VERIFY(!runner.busy());
  }

  /// A run that would take 60 s stops well within 200 ms, and the interface stays alive meanwhile.
  void cancelStopsALongRun() {
    Runner runner(longEngine());
    QSignalSpy stopped(&runner, &Runner::stopped), finished(&runner, &Runner::finished), progressed(&runner, &Runner::progressed);
    runner.inspect(pipeline_, {});
    QTRY_VERIFY(progressed.count() > 0);
    QElapsedTimer clock;
    clock.start();
    runner.cancel();
    QVERIFY(stopped.wait(5000));
    QVERIFY(!runner.busy());
    qInfo("stopped after %lld ms", static_cast<long long>(clock.elapsed()));
    QCOMPARE(finished.count(), 0);
  }

  void theNewestRequestWins() {
    std::atomic<int> completed{0};
    Engine engine = longEngine();
    engine.ask = [slow = engine.ask, &completed](Pipeline& pipeline, const Question& q, const ProgressFn& progress) {
      if (q.request.seed < 5) return slow(pipeline, q, progress);
      ++completed;
      return drawn(pipeline, q);
    };
    Runner runner(engine);
    QSignalSpy finished(&runner, &Runner::finished), stopped(&runner, &Runner::stopped), failed(&runner, &Runner::failed);
    InspectionRequest request;
    for (request.seed = 1; request.seed <= 5; ++request.seed) runner.inspect(pipeline_, request);
    QVERIFY(finished.wait());
    QTRY_VERIFY(!runner.busy());
    QCOMPARE(finished.count(), 1);
    QCOMPARE(finished[0][1].value<OpenedPtr>()->request.seed, 5u);
    QCOMPARE(completed.load(), 1);
    QCOMPARE(stopped.count() + failed.count(), 0);  // overtaken runs are no news
  }

  void theFrameThatIsLookedAtComesFirst() {
    Engine engine = fixture_.engine();
    std::atomic<int> frameAsked{-1};
    engine.ask = [&](Pipeline& pipeline, const Question& q, const ProgressFn&) -> Pipeline::Answer {
      if (q.part == Question::Part::FirstLook) return nullptr;
      if (q.part == Question::Part::Frame) frameAsked = q.frame;
      return drawn(pipeline, q);
    };
    Runner runner(engine);
    QStringList order;
    connect(&runner, &Runner::frameFinished, this, [&](const InspectionPtr&, int frame) { order << QString::number(frame); });
    connect(&runner, &Runner::finished, this, [&] { order << "all"; });
    runner.inspect(pipeline_, {}, 3);
    QTRY_COMPARE(order, QStringList({"3", "all"}));
    QCOMPARE(frameAsked.load(), 3);
    order.clear();
    runner.inspect(pipeline_, {});  // nobody looks at any
    QTRY_COMPARE(order, QStringList({"all"}));
  }

  /// Models that are quick are seen before those that are not.
  void quickModelsComeBeforeTheOthers() {
    Engine engine = fixture_.engine();
    std::atomic<bool> worthIt{true};
    engine.ask = [&](Pipeline& pipeline, const Question& q, const ProgressFn&) -> Pipeline::Answer {
      if (q.part != Question::Part::FirstLook) return drawn(pipeline, q);
      if (!worthIt) return nullptr;
      Inspection quick = *drawn(pipeline, q);
      quick.work.fits = 55;
      return std::make_shared<const Inspection>(std::move(quick));
    };
    Runner runner(engine);
    QStringList order;
    connect(&runner, &Runner::frameFinished, this,
            [&](const InspectionPtr& inspection, int) { order << (inspection->work.fits == 55 ? "quick" : "frame"); });
    connect(&runner, &Runner::finished, this, [&] { order << "all"; });
    runner.inspect(pipeline_, {}, 3);
    QTRY_COMPARE(order, QStringList({"quick", "frame", "all"}));
    order.clear();
    worthIt = false;
    runner.inspect(pipeline_, {}, 3);
    QTRY_COMPARE(order, QStringList({"frame", "all"}));
  }

  void everyPositionOfADragGetsItsFrameAndTheLastOneEverything() {
    Engine engine = fixture_.engine();
    engine.ask = [](Pipeline& pipeline, const Question& q, const ProgressFn&) -> Pipeline::Answer {
      return q.part == Question::Part::FirstLook ? nullptr : drawn(pipeline, q);
    };
    Runner runner(engine);
    std::vector<unsigned> frames, all;
    connect(&runner, &Runner::frameFinished, this,
            [&](const InspectionPtr& inspection, int) { frames.push_back(inspection->request.seed); });
    connect(&runner, &Runner::finished, this,
            [&](const InspectionPtr&, const OpenedPtr& computedFor) { all.push_back(computedFor->request.seed); });
    InspectionRequest request;
    for (request.seed = 1; request.seed <= 8; ++request.seed) {
      runner.inspect(pipeline_, request, 0);
      QTRY_COMPARE(frames.size(), std::size_t(request.seed));
    }
    QTRY_VERIFY(!all.empty() && all.back() == 8u);
    QCOMPARE(frames, (std::vector<unsigned>{1, 2, 3, 4, 5, 6, 7, 8}));
  }

  /// A hand that keeps dragging does not wait for runs that take longer than their first allowance.
  void aSlowFrameIsSeenWhileTheHandMoves() {
    Engine engine = fixture_.engine();
    engine.ask = [](Pipeline& pipeline, const Question& q, const ProgressFn& progress) -> Pipeline::Answer {
      if (q.part == Question::Part::FirstLook) return nullptr;
      for (int i = 0; q.part == Question::Part::Frame && i < 2 * Runner::kGraceMs / 10; ++i) {
        if (!report(progress, {"fit", i, 100})) throw Stopped{};
        QThread::msleep(10);
      }
      return drawn(pipeline, q);
    };
    Runner runner(engine);
    QSignalSpy frames(&runner, &Runner::frameFinished);
    InspectionRequest request;
    QElapsedTimer clock;
    clock.start();
    while (frames.isEmpty() && clock.elapsed() < 20'000) {
      ++request.seed;
      runner.inspect(pipeline_, request, 0);
      QTest::qWait(Runner::kGraceMs / 5);
    }
    QVERIFY(!frames.isEmpty());
    runner.cancel();
    QTRY_VERIFY(!runner.busy());
  }

  void undoToFinishedResultsRunsNothing() {
    Engine engine = fixture_.engine();
    std::atomic<int> runs{0};
    engine.ask = [&runs](Pipeline& pipeline, const Question& q, const ProgressFn&) -> Pipeline::Answer {
      if (q.part != Question::Part::Everything) return nullptr;
      ++runs;
      return drawn(pipeline, q);
    };
    MainWindow window(engine);
    window.open(toQString(fixture_.opened().path));
    Document& document = window.document();
    QTRY_VERIFY(window.idle() && document.inspection());
    document.setSetting("detect.level", 0.3);
    QTRY_VERIFY(window.idle() && !document.stale());
    QCOMPARE(runs.load(), 2);
    document.undoStack()->undo();
    QVERIFY(!document.stale());
    QCOMPARE(document.inspection()->request.settings.number("detect.level"), 0.5);
    QTRY_VERIFY(window.idle());
    QCOMPARE(runs.load(), 2);
    QVERIFY(window.findChild<LogPanel*>()->text().contains(QStringLiteral("Taken from before")));
    document.setSetting("detect.level", 0.4);  // another one is computed as ever
    QTRY_VERIFY(window.idle() && !document.stale());
    QCOMPARE(runs.load(), 3);
  }

  void wrongInputIsOneLine() {
    Runner runner(fixture_.engine());
    QSignalSpy failed(&runner, &Runner::failed), opened(&runner, &Runner::opened);
    runner.open("nowhere/scene.json");
    QVERIFY(failed.wait());
    QVERIFY(failed[0][0].toString().contains("nowhere/scene.json"));
    QVERIFY(!failed[0][0].toString().contains('\n'));
    QCOMPARE(opened.count(), 0);
  }

  void onlyCancelStopsASave() {
    Engine engine = fixture_.engine();
    std::atomic<bool> saving{false};
    engine.save = [&saving](const Opened&, const Inspection*, const std::string&, const ProgressFn& progress) {
      saving = true;
      for (int i = 0; i < 50; ++i) {
        if (!report(progress, {"hash", i, 50})) throw Stopped{};
        QThread::msleep(2);
      }
    };
    Runner runner(engine);
    QSignalSpy saved(&runner, &Runner::saved), failed(&runner, &Runner::failed);
    runner.save(std::make_shared<const Opened>(), nullptr, "a.glint");
    QTRY_VERIFY(saving);
    runner.open("nowhere/scene.json");
    QTRY_COMPARE(failed.count(), 1);
    QCOMPARE(saved.count(), 1);
    QCOMPARE(saved[0], QList<QVariant>({"a.glint", ""}));
    saving = false;
    runner.save(std::make_shared<const Opened>(), nullptr, "b.glint");
    QTRY_VERIFY(saving);
    runner.cancel();
    QTRY_COMPARE(saved.count(), 2);
    QVERIFY(saved[1][1].toString().contains("b.glint: saving stopped"));
  }

  void destructionStopsWhatRuns() {
    QElapsedTimer clock;
    clock.start();
    {
      Runner runner(longEngine());
      QSignalSpy progressed(&runner, &Runner::progressed);
      runner.inspect(pipeline_, {});
      QTRY_VERIFY(progressed.count() > 0);
    }
    QVERIFY(clock.elapsed() < 30000);
  }

 private:
  Engine longEngine() const {
    Engine engine = fixture_.engine();
    engine.ask = [](Pipeline& pipeline, const Question& q, const ProgressFn& progress) {
      for (int i = 0; i < 6000; ++i) {
        if (!report(progress, {"fit", i, 6000})) throw Stopped{};
        QThread::msleep(10);
      }
      return drawn(pipeline, q);
    };
    return engine;
  }
  Fixture fixture_;
  const std::shared_ptr<Pipeline> pipeline_ = std::make_shared<Pipeline>(fixture_.scene());
};

QObject* makeRunnerTest() { return new RunnerTest; }

}  // namespace glint::gui

#include "runner_test.moc"
