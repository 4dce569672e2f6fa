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

}  // namespace glint
