// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>

namespace glint {

/// One report of a running stage. `done`/`total` count units of work (frames, views), total 0 when unknown.
struct StageEvent {
  std::string stage;  ///< "detect", "surface", "light", "fit", "predict", "evaluate", ...
  int done = 0;
  int total = 0;
};

/// Called often (at least every 50 ms of work); returns false to ask the work to stop. May be empty.
using ProgressFn = std::function<bool(const StageEvent&)>;

/// True when the caller wants to go on (an empty function always goes on).
inline bool report(const ProgressFn& progress, const StageEvent& event) { return !progress || progress(event); }

/// Thrown by long work when the progress function said stop; caught once, in cli/ and gui/.
struct Stopped {};

/// Calls work(i) for i in [0, n) from several threads (the hardware's, at most 8; one when n is 1). Reports progress from any of
/// them, one at a time. A loop inside of another one's work runs in the thread that calls it. Throws Stopped when the progress
/// function says stop, and rethrows the first exception of `work` or `progress`. Uses its own threads: if the system gives no
/// more, oneTBB 2021.8 ends the program ("pthread_create has failed"), while this loop goes on with those it has.
void parallelFor(int n, const std::function<void(int)>& work, const ProgressFn& progress, const std::string& stage);

}  // namespace glint
