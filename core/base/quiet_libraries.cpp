// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/quiet_libraries.h"

#include <fcntl.h>
#include <unistd.h>

#include <atomic>
#include <cstdio>
#include <mutex>

namespace glint {
namespace {

std::mutex mutex;
int living = 0;  // under the mutex
std::atomic<int> kept{STDERR_FILENO};

}  // namespace

int ownErrors() { return kept; }

QuietLibraries::QuietLibraries() {
  const std::lock_guard<std::mutex> lock(mutex);
  if (living++ > 0) return;
  std::fflush(stderr);
  const int nowhere = ::open("/dev/null", O_WRONLY | O_CLOEXEC), own = ::fcntl(STDERR_FILENO, F_DUPFD_CLOEXEC, 3);
  if (nowhere >= 0 && own >= 0) {
    kept = own;
    ::dup2(nowhere, STDERR_FILENO);
  } else if (own >= 0) {
    ::close(own);  // no descriptor is left: libraries are heard
  }
  if (nowhere >= 0) ::close(nowhere);
}

QuietLibraries::~QuietLibraries() {
  const std::lock_guard<std::mutex> lock(mutex);
  if (--living > 0 || kept == STDERR_FILENO) return;
  std::fflush(stderr);
  const int own = kept;
  ::dup2(own, STDERR_FILENO);
  kept = STDERR_FILENO;
  ::close(own);
}

}  // namespace glint
