// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>

#include "core/base/progress.h"

namespace glint {

/// Calls work(i) for i in [0, n) from several threads (the hardware's, at most 8; one when n is 1). Reports progress from any of
/// them, one at a time. A loop inside of another one's work runs in the thread that calls it. Throws Stopped when the progress
/// function says stop, and rethrows the first exception of `work` or `progress`. Uses its own threads: if the system gives no
/// more, oneTBB 2021.8 ends the program ("pthread_create has failed"), while this loop goes on with those it has.
void parallelFor(int n, const std::function<void(int)>& work, const ProgressFn& progress, const std::string& stage);

}  // namespace glint
