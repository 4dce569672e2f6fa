// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QObject>
#include <QRunnable>
#include <QString>
#include <atomic>
#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "core/base/progress.h"

namespace glint::gui {

class JobQueue;

/// How a job ended.
class JobEnd {
 public:
  bool stopped = false;    ///< its work threw Stopped, or it was stopped before it began
  bool overtaken = false;  ///< meanwhile something newer was asked for
  /// What its work threw, as one line; "" = nothing. If nothing asks for it, unexpected() reports it: no failure gets lost.
  const QString& failure() const { return asked_ = true, failure_; }

 private:
  friend class JobQueue;
  QString failure_;
  mutable bool asked_ = false;
};

/// With what its work returned, unless it was stopped or failed.
template <class T>
struct JobResult : JobEnd {
  std::optional<std::conditional_t<std::is_void_v<T>, std::monostate, T>> value;
};

enum class Asks {
  AsWell,   ///< in addition to earlier jobs
  Newest,   ///< replaces earlier jobs: waiting ones are dropped, running ones can ask whether they were overtaken
  Instead,  ///< and what runs is stopped
  Lasting   ///< as AsWell, and nothing that is asked for later overtakes or stops it
};

/// What a job knows, on its thread, of its requester.
class JobToken {
 public:
  bool stopped() const { return job_->stopped; }
  bool overtaken() const { return job_->overtaken; }
  bool wanted() const { return !stopped() && !overtaken(); }
  /// Runs something on the owner's thread, soon: in the order of the calls, before the job's end, not once the queue is gone.
  void deliver(std::function<void()> what) const;
  /// The same, and waits for it. Throws what `what` throws; Stopped.
  void onOwner(const std::function<void()>& what) const;
  /// For the computing core: says stop when the job is stopped, and shows on the owner's thread how far it is.
  ProgressFn progress(std::function<void(const StageEvent&)> show) const;

 private:
  friend class JobQueue;
  struct Job {
    std::shared_ptr<JobEnd> end;
    std::function<void(const JobToken&)> work;
    std::function<void()> done;
    bool lasting = false;
    bool begun = false;  ///< guarded by the queue's mutex
    std::atomic<bool> stopped{false}, overtaken{false};
  };
  JobToken(JobQueue& queue, std::shared_ptr<const Job> job) : queue_(&queue), job_(std::move(job)) {}
  JobQueue* queue_;
  std::shared_ptr<const Job> job_;
};

/// Runs the jobs of one owner off its thread, one after the other. A job is asked for, and its end told, on the owner's thread
/// (that of this object); nothing is told once this object is gone. The owner declares it as its last member: what jobs use
/// outlives it.
class JobQueue : public QObject, private QRunnable {
  Q_OBJECT
 public:
  /// Background: behind the interface where cores are scarce, as are threads that a job starts. Foreground: the user waits for
  /// it.
  enum class Rank { Background, Foreground };
  explicit JobQueue(Rank rank = Rank::Background) : rank_(rank) { setAutoDelete(false); }
  ~JobQueue() override { close(); }

  /// @param work  T(const JobToken&), on another thread; must not touch widgets. What it throws ends the job alone.
  /// @param done  void(const JobResult<T>&), once, unless the job was dropped before it began.
  template <class Work, class Done>
  void start(Work work, Done done, Asks asks = Asks::AsWell) {
    using T = std::invoke_result_t<Work&, const JobToken&>;
    const auto result = std::make_shared<JobResult<T>>();
    auto fill = [result, work = std::move(work)](const JobToken& token) mutable {
      if constexpr (std::is_void_v<T>)
        work(token), result->value.emplace();
      else
        result->value.emplace(work(token));
    };
    post(
        result, std::move(fill), [result, done = std::move(done)]() mutable { done(*result); }, asks);
  }
  /// No job is needed any longer: drops waiting ones, overtakes running ones.
  void drop() { overtake(false), tellBusy(); }
  /// All jobs end soon, as stopped.
  void stop() {
    for (const auto& job : jobs_) job->stopped = true;
  }
  /// Waits until all jobs have run; their ends are reported later, as always.
  void wait() {
    std::unique_lock<std::mutex> lock(mutex_);
    rested_.wait(lock, [this] { return !running_; });
  }
  /// Drops waiting jobs, stops running ones and waits for them.
  void close() { overtake(true, true), wait(); }
  /// Jobs are waiting or running, or the end of the last one is being told.
  bool busy() const { return !jobs_.empty(); }

 signals:
  void busyChanged(bool busy);  ///< true when a job is asked for; false if the end of the last one has been told

 private:
  using Job = JobToken::Job;
  void post(std::shared_ptr<JobEnd> end, std::function<void(const JobToken&)> work, std::function<void()> done, Asks asks);
  void run() override;
  void tellEnd(const std::shared_ptr<Job>& job);
  void overtake(bool stop, bool lastingToo = false);
  void tellBusy() {
    if (busy() != std::exchange(toldBusy_, busy())) emit busyChanged(toldBusy_);
  }

  const Rank rank_;
  std::vector<std::shared_ptr<Job>> jobs_;  ///< asked for, their end not yet reported; owner's thread only
  bool toldBusy_ = false;
  std::mutex mutex_;  ///< guards the members below
  std::condition_variable rested_;
  std::deque<std::shared_ptr<Job>> waiting_;
  bool running_ = false;
};

/// Failures of jobs without a place in a panel, for the window to report: each cause once, not once per frame.
class Unexpected : public QObject {
  Q_OBJECT
 public:
  void add(const QString& oneLine);
  void forget() { told_.clear(); }  ///< for another scene all causes are new

 signals:
  void problem(const QString& oneLine);

 private:
  std::set<QString> told_;
};
Unexpected& unexpected();  ///< those of this program; interface thread only

}  // namespace glint::gui
