// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace glint::cli {

/// While it lives, Ctrl-C and SIGTERM ask the work to stop (`interrupted`), and a thread ends the program with code 130 when
/// the work has not stopped 100 ms later. Create it in main before any other thread.
class InterruptGuard {
 public:
  InterruptGuard();
  ~InterruptGuard();
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;
};

/// True after the first Ctrl-C.
bool interrupted();

/// True for the first caller only, who then says that the program was stopped: the thread and the command may both come to it.
bool claimStopMessage();

/// Ends an interrupted process without waiting for destructors, which may take longer than is promised; unfinished writes are removed.
[[noreturn]] void leaveAtOnce(int exitCode);

}  // namespace glint::cli
