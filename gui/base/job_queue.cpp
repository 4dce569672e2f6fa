// SPDX-License-Identifier: BSD-3-Clause
#include "gui/base/job_queue.h"

#include <QElapsedTimer>
#include <QPointer>
#include <QRegularExpression>
#include <QThread>
#include <QThreadPool>
#include <exception>
#include <future>

#include "gui/base/text.h"

#ifdef __linux__
#include <sys/resource.h>
#endif

namespace glint::gui {

namespace {
constexpr int kShowEveryMs = 40;  // progress on screen needs no more
constexpr std::chrono::milliseconds kAskAgain(50);
constexpr int kMostThreads = 1024;  // one for each queue that has work: no queue waits for another one's job

/// Never deleted: a program that is told to exit does not wait for what runs.
QThreadPool& threads(JobQueue::Rank rank) {
  static QThreadPool* const pools[] = {new QThreadPool, new QThreadPool};
  pools[int(rank)]->setMaxThreadCount(kMostThreads);
  return *pools[int(rank)];
}

void goBehindTheInterface() {
#ifdef __linux__
  // Qt's priorities have no effect on Linux, where the ordinary scheduler knows one for all; "nice" is per thread there.
  constexpr int kNice = 10;  // about a tenth of the time that a thread of the interface gets, when both want all of it
  setpriority(PRIO_PROCESS, 0, kNice);
#else
  QThread::currentThread()->setPriority(QThread::LowPriority);
#endif
}
}  // namespace

void JobToken::deliver(std::function<void()> what) const {
  QMetaObject::invokeMethod(queue_, std::move(what), Qt::QueuedConnection);
}

void JobToken::onOwner(const std::function<void()>& what) const {
  const auto taken = std::make_shared<std::atomic<bool>>(false);  // by the owner to run it, or by the job to give it up
  const auto task = std::make_shared<std::packaged_task<void()>>([&what, token = *this] {
    if (token.stopped()) throw Stopped{};
    what();
  });
  std::future<void> ended = task->get_future();
  deliver([taken, task] {
    if (!taken->exchange(true)) (*task)();
  });
  while (ended.wait_for(kAskAgain) != std::future_status::ready)
    if (stopped() && !taken->exchange(true)) throw Stopped{};
  ended.get();
}

ProgressFn JobToken::progress(std::function<void(const StageEvent&)> show) const {
  return [token = *this, show = std::move(show), shown = std::make_shared<QElapsedTimer>()](const StageEvent& event) {
    if (token.stopped()) return false;
    if (shown->isValid() && shown->elapsed() < kShowEveryMs) return true;
    shown->start();
    token.deliver([show, event] { show(event); });
    return true;
  };
}

void JobQueue::post(std::shared_ptr<JobEnd> end, std::function<void(const JobToken&)> work, std::function<void()> done,
                    Asks asks) {
  if (asks == Asks::Newest || asks == Asks::Instead) overtake(asks == Asks::Instead);
  jobs_.emplace_back(new Job{std::move(end), std::move(work), std::move(done), asks == Asks::Lasting});
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    waiting_.push_back(jobs_.back());
    if (!std::exchange(running_, true)) threads(rank_).start(this);
  }
  tellBusy();
}

void JobQueue::run() {
  if (rank_ == Rank::Background) goBehindTheInterface();
  std::unique_lock<std::mutex> lock(mutex_);
  while (!waiting_.empty()) {
    std::shared_ptr<Job> job = std::move(waiting_.front());
    waiting_.pop_front();
    job->begun = true;
    lock.unlock();
    try {
      if (job->stopped) throw Stopped{};
      job->work(JobToken(*this, job));
    } catch (const Stopped&) {
      job->end->stopped = true;
    } catch (const std::exception& e) {
      job->end->failure_ = *e.what() ? toQString(e.what()) : tr("unknown failure");
    } catch (...) {
      job->end->failure_ = tr("unknown failure");
    }
    QMetaObject::invokeMethod(
        this, [this, job] { tellEnd(job); }, Qt::QueuedConnection);
    job->work = nullptr;  // large results that it used may go with it: here, not on the owner's thread
    job.reset();
    lock.lock();
  }
  running_ = false;
  rested_.notify_all();
}

void JobQueue::tellEnd(const std::shared_ptr<Job>& job) {
  const QPointer<JobQueue> alive(this);  // what is told may end the owner
  job->end->overtaken = job->overtaken;
  job->done();
  if (!job->end->asked_ && !job->end->failure_.isEmpty()) unexpected().add(job->end->failure_);
  if (!alive) return;
  std::erase(jobs_, job);
  tellBusy();
}

void JobQueue::overtake(bool stop, bool lastingToo) {
  const std::lock_guard<std::mutex> lock(mutex_);
  for (const std::shared_ptr<Job>& job : jobs_)
    if (lastingToo || !job->lasting) job->overtaken = true, job->stopped = job->stopped || stop;
  std::erase_if(waiting_, [](const std::shared_ptr<Job>& job) { return job->overtaken.load(); });
  std::erase_if(jobs_, [](const std::shared_ptr<Job>& job) { return job->overtaken && !job->begun; });
}

void Unexpected::add(const QString& oneLine) {
  static const QRegularExpression numbers(QStringLiteral("[0-9]+"));  // of frames, sizes, lines: the cause is the same
  const QString cause = QString(oneLine).remove(numbers);
  if (told_.insert(cause).second) emit problem(oneLine);
}

Unexpected& unexpected() {
  static Unexpected all;
  return all;
}

}  // namespace glint::gui
