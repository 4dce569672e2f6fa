// SPDX-License-Identifier: BSD-3-Clause
#include "cli/interrupt.h"

#include <pthread.h>
#include <signal.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <mutex>
#include <string_view>
#include <system_error>
#include <thread>

#include "core/base/atomic_file.h"
#include "core/base/quiet_libraries.h"

namespace glint::cli {
namespace {

enum class State { Working, Stopping, Finished };
std::atomic<State> state{State::Working};
std::timed_mutex sayMutex;
bool said = false;  // under the mutex
std::thread waiter;

void writeStopped() {
  // The first characters take back a progress line.
  constexpr std::string_view kOnTerminal = "\r\x1b[Kglint: stopped\n", kElsewhere = "glint: stopped\n";
  const std::string_view line = ::isatty(ownErrors()) == 1 ? kOnTerminal : kElsewhere;
  (void)!::write(ownErrors(), line.data(), line.size());
}

void endAtOnce(int) {
  writeStopped();
  ::_exit(130);
}

void handleBySignal() {
  struct sigaction action {};
  action.sa_handler = endAtOnce;
  for (const int signal : {SIGINT, SIGTERM}) ::sigaction(signal, &action, nullptr);
}

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
  State before = State::Working;
  if (!state.compare_exchange_strong(before, State::Stopping)) return;
  // The work should notice within this time; where it cannot (inside a library), nothing of it is kept anyway. Together with the
  // end of the process it stays below the 200 ms that are promised.
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  removeUnfinishedWrites();
  sayStopped();
  ::_exit(130);
}

// Runs before the constructors of the libraries and of this program: a signal during these ends the program as any other does.
__attribute__((section(".preinit_array"), used)) void (*const earliest)() = handleBySignal;

}  // namespace

bool interrupted() { return state == State::Stopping; }

bool finish() {
  State before = State::Working;
  return state.compare_exchange_strong(before, State::Finished) || before == State::Finished;
}

void sayStopped() {
  // Its holder writes one line; a blocked standard error must not keep the program.
  const std::unique_lock<std::timed_mutex> lock(sayMutex, std::chrono::milliseconds(20));
  if (!lock || said) return;
  said = true;
  writeStopped();
}

void leaveAtOnce(int exitCode) {
  std::fflush(stdout);
  removeUnfinishedWrites();
  ::_exit(exitCode);
}

InterruptGuard::InterruptGuard() {
  // A broken pipe is an error of the write, not a reason to vanish; neither is a file that grows beyond the limit.
  ::signal(SIGPIPE, SIG_IGN);
  ::signal(SIGXFSZ, SIG_IGN);
  const sigset_t set = stopSignals();
  pthread_sigmask(SIG_BLOCK, &set, nullptr);
  try {
    waiter = std::thread(waitForSignals);
  } catch (const std::system_error&) {
    // The system gives no thread: a signal ends the program at once, and what it was writing is removed by the next one.
    pthread_sigmask(SIG_UNBLOCK, &set, nullptr);
  }
}

InterruptGuard::~InterruptGuard() {
  if (!waiter.joinable()) return;
  if (interrupted()) {
    waiter.detach();  // it sleeps; main returns first
    return;
  }
  pthread_kill(waiter.native_handle(), SIGUSR1);
  waiter.join();
  // The rest is the end of the process. It may wait for the reader of the output, so a signal has to end it as before main.
  const sigset_t set = stopSignals();
  pthread_sigmask(SIG_UNBLOCK, &set, nullptr);
}

}  // namespace glint::cli
