// SPDX-License-Identifier: BSD-3-Clause
#include <QSignalSpy>
#include <QThread>
#include <atomic>
#include <memory>
#include <stdexcept>
#include <thread>
#include <vector>

#include "gui/base/job_queue.h"
#include "gui/base/latest_job.h"
#include "tests/gui/fixture.h"

namespace glint::gui {

namespace {
/// Holds a job until the test lets it go on.
struct Gate {
  std::atomic<bool> reached{false}, open{false};
  void pass() {
    reached = true;
    while (!open) QThread::msleep(1);
  }
};
}  // namespace

class JobsTest : public QObject {
  Q_OBJECT
 private slots:
  void theValueArrivesOnTheThreadThatAsked() {
    JobQueue queue;
    QList<bool> busy;
    connect(&queue, &JobQueue::busyChanged, this, [&](bool now) { busy << now; });
    QThread* ran = nullptr;
    int got = 0;
    queue.start(
        [&](const JobToken&) {
          ran = QThread::currentThread();
          return std::make_unique<int>(7);  // need not be copied
        },
        [&](JobResult<std::unique_ptr<int>>& result) {
          QCOMPARE(QThread::currentThread(), thread());
          QVERIFY(queue.busy() && !result.stopped && !result.overtaken && result.failure().isEmpty());
          QCOMPARE(busy, QList<bool>({true}));
          got = **result.value;
        });
    QVERIFY(queue.busy());
    QTRY_COMPARE(got, 7);
    QVERIFY(ran && ran != QThread::currentThread());
    QCOMPARE(busy, QList<bool>({true, false}));
  }

  void jobsRunOneAfterTheOtherAndDeliverInOrder() {
    JobQueue queue;
    QStringList order;
    std::atomic<int> atOnce{0}, most{0};
    for (int i = 0; i < 20; ++i)
      queue.start(
          [&, i](const JobToken& token) {
            most = std::max(most.load(), ++atOnce);
            for (const char* part : {"a", "b"}) token.deliver([&order, i, part] { order << QString::number(i) + part; });
            --atOnce;
          },
          [&order, i](const JobResult<void>&) { order << QString::number(i); });
    QTRY_VERIFY(!queue.busy());
    QStringList expected;
    for (int i = 0; i < 20; ++i)
      for (const char* part : {"a", "b", ""}) expected << QString::number(i) + part;
    QCOMPARE(order, expected);
    QCOMPARE(most.load(), 1);
  }

  void theNewestWinsAndWhatWaitsIsDropped() {
    JobQueue queue;
    Gate gate;
    std::vector<int> ran, told;
    std::vector<bool> overtaken;
    bool found = false;
    for (int i = 0; i < 5; ++i) {
      queue.start(
          [&, i](const JobToken& token) {
            ran.push_back(i);
            if (i > 0) return i;
            gate.pass();
            found = token.overtaken() && !token.wanted() && !token.stopped();
            return i;
          },
          [&](const JobResult<int>& result) {
            told.push_back(*result.value);
            overtaken.push_back(result.overtaken);
          },
          Asks::Newest);
      QTRY_VERIFY(gate.reached);  // the first one runs by now
    }
    gate.open = true;
    QTRY_VERIFY(!queue.busy());
    QCOMPARE(ran, (std::vector<int>{0, 4}));
    QCOMPARE(told, (std::vector<int>{0, 4}));
    QCOMPARE(overtaken, (std::vector<bool>{true, false}));
    QVERIFY(found);
  }

  /// A job is overtaken between its end and the moment at which the end is reported.
  void whatHasEndedCanStillBeOvertaken() {
    JobQueue queue;
    std::vector<bool> overtaken;
    for (int i = 0; i < 2; ++i) {
      queue.start([](const JobToken&) {}, [&](const JobResult<void>& result) { overtaken.push_back(result.overtaken); },
                  Asks::Newest);
      queue.wait();
    }
    QTRY_VERIFY(!queue.busy());
    QCOMPARE(overtaken, (std::vector<bool>{true, false}));
  }

  void aFailureArrivesAsOneLine() {
    JobQueue queue;
    QStringList failures;
    QSignalSpy told(&unexpected(), &Unexpected::problem);
    const auto done = [&](const JobResult<void>& result) { failures << result.failure(); };
    queue.start([](const JobToken&) { throw std::runtime_error("frames/0003.png: cut off"); }, done);
    queue.start([](const JobToken&) { throw 7; }, done);
    queue.start([](const JobToken&) {}, done);
    QTRY_VERIFY(!queue.busy());
    QCOMPARE(failures, QStringList({"frames/0003.png: cut off", "unknown failure", ""}));
    QCOMPARE(told.count(), 0);  // somebody asked
  }

  void aFailureThatNobodyAsksForIsToldOncePerCause() {
    unexpected().forget();
    QSignalSpy told(&unexpected(), &Unexpected::problem);
    LatestJob job;
    const auto fail = [&](const std::string& line) {
      bool delivered = false;
      job.run([&delivered, line]() -> LatestJob::Deliver {
        if (!line.empty()) throw std::runtime_error(line);
        return [&delivered] { delivered = true; };
      });
      QTRY_VERIFY(!job.busy());
      QVERIFY(!job.awaited());
      QCOMPARE(delivered, line.empty());
    };
    fail("no memory for frame 3");
    fail("no memory for frame 41");
    QCOMPARE(told.count(), 1);
    QCOMPARE(told[0][0].toString(), QString("no memory for frame 3"));
    fail("another cause");
    QCOMPARE(told.count(), 2);
    fail("");
    unexpected().forget();
    fail("no memory for frame 5");
    QCOMPARE(told.count(), 3);
    unexpected().forget();
  }

  void stoppingEndsWhatRunsAndWhatWaits() {
    JobQueue queue;
    int shown = 0, ran = 0;
    QStringList ends;
    const auto done = [&](const JobResult<void>& result) {
      ends << (result.stopped ? "stopped" : result.overtaken ? "overtaken" : "done");
      QVERIFY(result.failure().isEmpty());
    };
    const auto endless = [&](const JobToken& token) {
      ++ran;
      const ProgressFn progress = token.progress([&](const StageEvent& e) { shown += e.stage == "fit"; });
      while (report(progress, {"fit", 1, 2})) QThread::msleep(1);
      throw Stopped{};
    };
    queue.start(endless, done);
    queue.start(endless, done, Asks::Lasting);
    QTRY_VERIFY(shown > 1);
    queue.stop();
    queue.start([](const JobToken&) {}, done);  // asked for afterwards
    QTRY_VERIFY(!queue.busy());
    QCOMPARE(ends, QStringList({"stopped", "stopped", "done"}));
    QCOMPARE(ran, 1);
  }

  void whatIsToLastIsNeitherOvertakenNorStoppedByWhatComesLater() {
    JobQueue queue;
    Gate gate;
    QStringList ends;
    const auto named = [&](const QString& name) {
      return [&ends, name](const JobResult<void>& result) {
        ends << name + (result.stopped ? " stopped" : "") + (result.overtaken ? " overtaken" : "");
      };
    };
    queue.start([&](const JobToken&) { gate.pass(); }, named("first"), Asks::Newest);
    bool wanted = false;
    queue.start([&](const JobToken& token) { wanted = token.wanted(); }, named("lasting"), Asks::Lasting);
    queue.start([](const JobToken&) {}, named("waits"), Asks::AsWell);
    queue.start([](const JobToken&) {}, named("instead"), Asks::Instead);
    gate.open = true;
    QTRY_VERIFY(!queue.busy());
    ends.removeOne("first overtaken");  // it had begun, or not
    QCOMPARE(ends, QStringList({"lasting", "instead"}));
    QVERIFY(wanted);
  }

  void nothingIsToldOnceTheQueueIsGone() {
    Gate gate;
    std::atomic<bool> ended{false};
    bool told = false, waitingRan = false;
    {
      JobQueue queue;
      queue.start(
          [&](const JobToken& token) {
            token.deliver([&] { told = true; });
            gate.reached = true;
            while (!token.stopped()) QThread::msleep(1);
            token.deliver([&] { told = true; });
            QThread::msleep(20);
            ended = true;
          },
          [&](const JobResult<void>&) { told = true; });
      queue.start([&](const JobToken&) { waitingRan = true; }, [&](const JobResult<void>&) { told = true; });
      while (!gate.reached) QThread::msleep(1);
    }
    QVERIFY(ended);
    QTest::qWait(20);
    QVERIFY(!told && !waitingRan);
  }

  void theEndOfAJobMayEndItsOwner() {
    auto queue = std::make_unique<JobQueue>();
    queue->start([](const JobToken&) { return 1; }, [&](const JobResult<int>&) { queue.reset(); });
    QTRY_VERIFY(!queue);
  }

  void dropIsTheEndOfBeingBusyWhereNothingRuns() {
    JobQueue queue;
    Gate gate;
    bool told = false, dropped = true;
    queue.start([&](const JobToken&) { gate.pass(); }, [&](const JobResult<void>& result) { told = result.overtaken; });
    QTRY_VERIFY(gate.reached);
    queue.start([&](const JobToken&) { dropped = false; }, [&](const JobResult<void>&) { dropped = false; });
    queue.drop();
    QVERIFY(queue.busy());
    gate.open = true;
    QTRY_VERIFY(!queue.busy());
    QVERIFY(told && dropped);
  }

  void aJobRunsSomethingOnTheOwnersThreadAndWaits() {
    JobQueue queue;
    QString failure;
    int seen = 0;
    queue.start(
        [&](const JobToken& token) {
          int there = 0;
          token.onOwner([&] { there = QThread::currentThread() == thread() ? 1 : -1; });
          seen = there;
          token.onOwner([] { throw std::runtime_error("cannot be drawn"); });
        },
        [&](const JobResult<void>& result) { failure = result.failure(); });
    QTRY_COMPARE(failure, QString("cannot be drawn"));
    QCOMPARE(seen, 1);
    // A job that waits for an owner that does not come back is let go.
    auto ending = std::make_unique<JobQueue>();
    Gate gate;
    bool stopped = false, ran = false;
    ending->start(
        [&](const JobToken& token) {
          gate.reached = true;
          try {
            token.onOwner([&] { ran = true; });
          } catch (const Stopped&) {
            stopped = true;
          }
        },
        [](const JobResult<void>&) {});
    while (!gate.reached) QThread::msleep(1);
    ending.reset();
    QVERIFY(stopped && !ran);
  }

  void waitingEndsWhenEverythingHasRun() {
    JobQueue queue(JobQueue::Rank::Foreground);
    int ran = 0, told = 0;
    for (int i = 0; i < 10; ++i) queue.start([&](const JobToken&) { ++ran; }, [&](const JobResult<void>&) { ++told; });
    queue.wait();
    QCOMPARE(ran, 10);
    QCOMPARE(told, 0);
    QTRY_COMPARE(told, 10);
    queue.wait();  // for nothing
  }

  void noQueueWaitsForAnother() {
    constexpr int kQueues = 12;  // more than the machine has cores
    std::atomic<int> here{0};
    std::vector<std::unique_ptr<JobQueue>> queues;
    int told = 0;
    for (int i = 0; i < kQueues; ++i) {
      queues.push_back(std::make_unique<JobQueue>(i % 2 ? JobQueue::Rank::Background : JobQueue::Rank::Foreground));
      queues.back()->start(
          [&](const JobToken& token) {
            ++here;
            while (here < kQueues && !token.stopped()) QThread::msleep(1);
          },
          [&](const JobResult<void>&) { ++told; });
    }
    QTRY_COMPARE(told, kQueues);
  }

  /// For the thread sanitizer: jobs are asked for, dropped and ended in quick succession.
  void manyQueuesComeAndGo() {
    std::atomic<int> ran{0};
    for (int round = 0; round < 60; ++round) {
      JobQueue queue(round % 2 ? JobQueue::Rank::Background : JobQueue::Rank::Foreground);
      int told = 0;
      for (int i = 0; i < 20; ++i) {
        const auto data = std::make_shared<std::vector<int>>(100, i);
        queue.start(
            [&ran, data](const JobToken& token) {
              ++ran;
              if (token.wanted()) token.deliver([data] { data->front() = 1; });
              return data->back();
            },
            [&told](const JobResult<int>&) { ++told; }, i % 4 ? Asks::AsWell : Asks::Newest);
        if (i % 7 == 0) QCoreApplication::processEvents();
      }
      if (round % 5 == 0) QTRY_VERIFY(!queue.busy());
    }
    QVERIFY(ran > 0);
  }
};

QObject* makeJobsTest() { return new JobsTest; }

}  // namespace glint::gui

#include "jobs_test.moc"
