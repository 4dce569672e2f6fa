// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace glint::cli {

/// While it lives, Ctrl-C and SIGTERM ask the work to stop (`interrupted`), and a thread ends the program with code 130 when
/// the work has not stopped 150 ms later. Create it in main before any other thread.
class InterruptGuard {
 public:
  InterruptGuard();
  ~InterruptGuard();
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;
};

/// True after the first Ctrl-C.
bool interrupted();

}  // namespace glint::cli
