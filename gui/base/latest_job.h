// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <type_traits>
#include <utility>

#include "gui/base/job_queue.h"

namespace glint::gui {

/// Runs small jobs off the interface thread; the newest wins: what waits is dropped, and the answer of a job that a newer one
/// overtook is not delivered.
class LatestJob {
 public:
  using Deliver = std::function<void()>;  ///< runs on the interface thread

  explicit LatestJob(JobQueue::Rank rank = JobQueue::Rank::Background) : queue_(rank) {}

  /// @param work  Deliver() or Deliver(const JobToken&): runs elsewhere, must not touch widgets, says what to do with its result.
  /// @param failed  takes what it throws, as one line; without it that is told as unexpected.
  template <class Work>
  void run(Work work, std::function<void(const QString&)> failed = {}) {
    awaited_ = true;
    queue_.start(
        [work = std::move(work)](const JobToken& token) mutable -> Deliver {
          if constexpr (std::is_invocable_v<Work&, const JobToken&>)
            return work(token);
          else
            return work();
        },
        [this, failed = std::move(failed)](const JobResult<Deliver>& result) {
          if (result.overtaken) return;
          awaited_ = false;
          if (result.value && *result.value) return (*result.value)();
          if (failed && !result.failure().isEmpty()) failed(result.failure());
        },
        Asks::Newest);
  }
  /// No job is needed any longer.
  void drop() { queue_.drop(), awaited_ = false; }
  bool busy() const { return queue_.busy(); }
  /// An answer will be delivered: the newest job runs and was not dropped. (A dropped one may still be busy.)
  bool awaited() const { return awaited_; }

 private:
  bool awaited_ = false;
  JobQueue queue_;
};

}  // namespace glint::gui
