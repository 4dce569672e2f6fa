// SPDX-License-Identifier: BSD-3-Clause
#include "cli/interrupt.h"

#include <pthread.h>
#include <signal.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <thread>

#include "core/base/atomic_file.h"

namespace glint::cli {
namespace {

std::atomic<bool> stopAsked{false};
std::atomic<bool> stopSaid{false};
std::thread waiter;

sigset_t stopSignals() {
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, SIGINT);
  sigaddset(&set, SIGTERM);
  sigaddset(&set, SIGUSR1);  // sent by the guard's end, so that the thread returns
  return set;
}

void waitForSignals() {
  const sigset_t set = stopSignals();
  int signal = 0;
  sigwait(&set, &signal);
  if (signal == SIGUSR1) return;
  stopAsked = true;
  // The work should notice within this time; where it cannot (inside a library), nothing of it is kept anyway. Together with the end
  // of the process it stays below the 200 ms that are promised.
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  removeUnfinishedWrites();
  static constexpr char message[] = "glint: stopped\n";
  if (claimStopMessage()) (void)!::write(STDERR_FILENO, message, sizeof message - 1);
  ::_exit(130);
}

}  // namespace

bool interrupted() { return stopAsked; }

void leaveAtOnce(int exitCode) {
  std::fflush(stdout);
  removeUnfinishedWrites();
  ::_exit(exitCode);
}

bool claimStopMessage() { return !stopSaid.exchange(true); }

InterruptGuard::InterruptGuard() {
  // A broken pipe is an error of the write, not a reason to vanish; neither is a file that grows beyond the limit.
  ::signal(SIGPIPE, SIG_IGN);
  ::signal(SIGXFSZ, SIG_IGN);
  const sigset_t set = stopSignals();
  pthread_sigmask(SIG_BLOCK, &set, nullptr);
  waiter = std::thread(waitForSignals);
}

InterruptGuard::~InterruptGuard() {
  if (stopAsked) {
    waiter.detach();  // it sleeps; main returns first
    return;
  }
  pthread_kill(waiter.native_handle(), SIGUSR1);
  waiter.join();
}

}  // namespace glint::cli
