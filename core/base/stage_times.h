// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <functional>
#include <mutex>
#include <string>
#include <vector>

#include "core/base/progress.h"

namespace glint {

/// How long each stage of a computation took, from its reports. Thread-safe.
class StageTimes {
 public:
  using Clock = std::function<double()>;  ///< seconds since any moment
  explicit StageTimes(Clock clock = {});  ///< empty = the steady clock
  /// A stage lasts from its first report to the first one of another stage. A stage that recurs counts once, with the sum.
  void note(const StageEvent& event);
  /// "detect 24 in 0.31 s, surface 6 in 0.02 s; 0.84 s in all", in the order of the stages; no time below a millisecond.
  std::string text() const;
  std::string stage() const;  ///< the one of the last report, "" before the first

 private:
  struct Stage {
    std::string name;
    int units = 0;
    double seconds = 0;
  };

  mutable std::mutex mutex_;
  Clock clock_;
  std::vector<Stage> stages_;
  std::size_t current_ = 0;
  double began_ = 0, since_ = 0;
};

using Clock = std::chrono::steady_clock;
inline double microsecondsSince(Clock::time_point start) {
  return std::chrono::duration<double, std::micro>(Clock::now() - start).count();
}

}  // namespace glint
