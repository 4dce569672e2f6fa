// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>

namespace glint::faults {

/// What the preloaded library (inject.cpp) counts and lets fail, and what the tests ask it for.
enum class Call {
  Open,    ///< a file for writing: open, fopen, creat
  Write,   ///< to a regular file other than standard error: write, writev, pwrite, sendfile, fwrite, fputs, fflush, fclose
  Rename,  ///< rename, link
  Sync,    ///< fsync, fdatasync
  Folder,  ///< mkdir
  Unlink,  ///< unlink, remove, rmdir
  Memory,  ///< malloc and its kin, anonymous mmap: from GLINT_FAULT_BYTES on (1 MiB)
  Thread,  ///< pthread_create
};
inline constexpr int kCalls = 8;
inline constexpr const char* kCallNames[kCalls] = {"open", "write", "rename", "sync", "folder", "unlink", "memory", "thread"};

/// Shared between the program and the test through the file GLINT_FAULT_COUNTS: it outlives a kill.
struct Counts {
  std::atomic<int> calls[kCalls];
  std::atomic<int> injected;  ///< how many calls failed or raised a signal
};

// GLINT_FAULT = CALL:N:ACTION, the N-th call from the first line of main on, counted over all threads. ACTION:
//   errno=E    fails with errno E
//   from=E     that one and all later ones fail with errno E (a disk that stays full)
//   short      a write takes only half of its bytes
//   signal=S   the process gets the signal S, then the call goes on
//   stuck=S    the same, and the call does not return (work inside a library that cannot be asked to stop)
// GLINT_FAULT = main:0:signal=S raises S before the first line of main. GLINT_FAULT_PROGRAM: only in the program of this name.

}  // namespace glint::faults
