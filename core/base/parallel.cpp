// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <exception>
#include <mutex>
#include <optional>
#include <system_error>
#include <thread>
#include <vector>

#include "core/base/memory.h"
#include "core/base/number_text.h"
#include "core/base/progress.h"

namespace glint {

namespace {
/// GLINT_THREADS where it is set (1 to 64), else the hardware's, at most 8.
int threadCount() {
  static const int count = [] {
    const char* asked = std::getenv("GLINT_THREADS");
    const std::optional<double> number = asked ? numberFrom(asked) : std::nullopt;
    if (number && *number >= 1) return static_cast<int>(std::min(*number, 64.0));
    return std::clamp<int>(static_cast<int>(std::thread::hardware_concurrency()), 1, 8);
  }();
  return count;
}

/// This thread works for a loop of several threads.
// Aligned for mold 1.10, which starts the read-only part at the thread-local data: with a single byte at the very end of a page,
// the part begins in a page that is not mapped, and the program does not start ("cannot apply additional memory protection").
alignas(64) thread_local bool inLoop = false;
struct InLoop {
  explicit InLoop(bool now) : before(inLoop) { inLoop = before || now; }
  ~InLoop() { inLoop = before; }
  const bool before;
};
}  // namespace

void parallelFor(int n, const std::function<void(int)>& work, const ProgressFn& progress, const std::string& stage) {
  std::atomic<int> next{0};
  int done = 0;  // under the mutex
  std::atomic<bool> stop{false}, stopped{false};
  std::exception_ptr error;
  std::mutex mutex;
  const int count = inLoop ? 1 : std::min({n, threadCount(), imagesAtOnce()});
  const auto run = [&] {
    const InLoop mark(count > 1);
    while (!stop) {
      const int i = next++;
      if (i >= n) return;
      try {
        work(i);
        const std::scoped_lock lock(mutex);
        if (!stop && !report(progress, {stage, ++done, n})) stopped = stop = true;
      } catch (...) {  // of `progress` too: nothing may leave a thread
        const std::scoped_lock lock(mutex);
        if (!error) error = std::current_exception();
        stop = true;
        return;
      }
    }
  };
  if (!report(progress, {stage, 0, n})) throw Stopped{};
  std::vector<std::thread> threads;
  try {
    for (int t = 1; t < count; ++t) threads.emplace_back(run);
  } catch (const std::system_error&) {
    // The system gives no more threads: those that run do the work.
  }
  run();
  for (std::thread& t : threads) t.join();
  if (error) std::rethrow_exception(error);
  if (stopped) throw Stopped{};
}

}  // namespace glint
