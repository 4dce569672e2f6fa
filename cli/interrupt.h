// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace glint::cli {

/// While it lives, Ctrl-C and SIGTERM ask the work to stop (`interrupted`), and a thread ends the program with code 130 when
/// the work has not stopped 100 ms later. Create it in main before any other thread. Before it lives, from the start of the
/// process on, and after it a signal ends the process at once, with the same message and code.
class InterruptGuard {
 public:
  InterruptGuard();
  ~InterruptGuard();
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;
};

/// True after the first Ctrl-C, unless the command was done before it.
bool interrupted();

/// The command is done, only its result remains to be said: a Ctrl-C changes nothing from now on. False if one came before.
bool finish();

/// Prints once that the program was stopped, whether the thread or the command comes first. Returns after the message.
void sayStopped();

/// Ends an interrupted process without waiting for destructors, which may take too long. Removes unfinished writes.
[[noreturn]] void leaveAtOnce(int exitCode);

}  // namespace glint::cli
