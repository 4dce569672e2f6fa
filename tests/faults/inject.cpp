// SPDX-License-Identifier: BSD-3-Clause
// Preloaded (LD_PRELOAD) into the program under test: counts its calls and lets one of them fail, see injected.h. Nothing here
// allocates.
#include <dlfcn.h>
#include <fcntl.h>
#include <pthread.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/sendfile.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <unistd.h>

#include <cerrno>

#include "tests/faults/injected.h"

using glint::faults::Call;
using glint::faults::Counts;
using glint::faults::kCallNames;
using glint::faults::kCalls;

namespace {

enum class Action { None, Once, From, Short, Signal, Stuck };

Counts own;  // where nobody asked for the counts
Counts* counts = &own;
Call faulty = Call::Open;
int at = 0, value = 0;
Action action = Action::None;
std::size_t largeBytes = std::size_t(1) << 20;
bool beforeMain = false;
std::atomic<bool> armed{false};

template <class F>
F real(const char* name) {
  return reinterpret_cast<F>(dlsym(RTLD_NEXT, name));
}
// Looked up at first use, once per function.
#define REAL(name) static const auto next = real<decltype(&::name)>(#name)

/// Counts a call and says what is to happen to it.
Action happens(Call call) {
  if (!armed.load(std::memory_order_relaxed)) return Action::None;
  const int n = ++counts->calls[int(call)];
  if (action == Action::None || call != faulty) return Action::None;
  if (action == Action::From ? n < at : n != at) return Action::None;
  ++counts->injected;
  if (action == Action::Signal || action == Action::Stuck) {
    kill(getpid(), value);  // to the process: any of its threads may take it
    while (action == Action::Stuck) pause();
    return Action::None;
  }
  return action;
}

bool fails(Call call) {
  const Action a = happens(call);
  if (a == Action::Once || a == Action::From) errno = value;
  return a == Action::Once || a == Action::From;
}

bool counted(int fd) {
  if (fd == STDERR_FILENO || fd < 0) return false;  // the message itself must come out
  struct stat info;
  const int before = errno;
  const bool regular = fstat(fd, &info) == 0 && S_ISREG(info.st_mode);
  errno = before;
  return regular;
}

bool writes(int flags) { return (flags & O_ACCMODE) != O_RDONLY; }
bool writes(const char* mode) { return strpbrk(mode, "wa+") != nullptr; }
bool isDevice(const char* path) { return strncmp(path, "/dev/", 5) == 0 || strncmp(path, "/proc/", 6) == 0; }

/// "write:3:errno=28". What cannot be read injects nothing.
void parse(const char* text) {
  const char* first = strchr(text, ':');
  const char* second = first ? strchr(first + 1, ':') : nullptr;
  if (!second) return;
  beforeMain = strncmp(text, "main:", 5) == 0;
  for (int i = 0; i < kCalls; ++i)
    if (strncmp(text, kCallNames[i], size_t(first - text)) == 0 && kCallNames[i][first - text] == 0) faulty = Call(i);
  at = atoi(first + 1);
  const char* equals = strchr(second, '=');
  if (equals) value = atoi(equals + 1);
  const struct {
    const char* name;
    Action action;
  } actions[] = {{":errno=", Action::Once},
                 {":from=", Action::From},
                 {":short", Action::Short},
                 {":signal=", Action::Signal},
                 {":stuck=", Action::Stuck}};
  for (const auto& a : actions)
    if (strncmp(second, a.name, strlen(a.name)) == 0) action = a.action;
}

using Main = int (*)(int, char**, char**);
Main programMain = nullptr;

int armedMain(int argc, char** argv, char** environment) {
  const char* only = getenv("GLINT_FAULT_PROGRAM");
  if (!only || strcmp(only, program_invocation_short_name) == 0) {
    if (const char* bytes = getenv("GLINT_FAULT_BYTES")) largeBytes = size_t(atoll(bytes));
    if (const char* file = getenv("GLINT_FAULT_COUNTS")) {
      const int fd = open(file, O_RDWR | O_CLOEXEC);
      void* shared = fd < 0 ? MAP_FAILED : mmap(nullptr, sizeof(Counts), PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
      if (fd >= 0) close(fd);
      if (shared != MAP_FAILED) counts = static_cast<Counts*>(shared);
    }
    if (const char* text = getenv("GLINT_FAULT")) parse(text);
    if (beforeMain) {
      ++counts->injected;
      kill(getpid(), value);
    }
    armed = true;
  }
  return programMain(argc, argv, environment);
}

}  // namespace

extern "C" {

#pragma GCC visibility push(default)

int __libc_start_main(Main main, int argc, char** argv, void (*init)(), void (*fini)(), void (*loaderFini)(), void* stackEnd) {
  using Start = int (*)(Main, int, char**, void (*)(), void (*)(), void (*)(), void*);
  programMain = main;
  return real<Start>("__libc_start_main")(armedMain, argc, argv, init, fini, loaderFini, stackEnd);
}

// ---- files for writing

int open(const char* path, int flags, ...) {
  va_list more;
  va_start(more, flags);
  const mode_t mode = (flags & (O_CREAT | O_TMPFILE)) ? va_arg(more, mode_t) : 0;
  va_end(more);
  if (writes(flags) && !isDevice(path) && fails(Call::Open)) return -1;
  REAL(open);
  return next(path, flags, mode);
}
int open64(const char* path, int flags, ...) {
  va_list more;
  va_start(more, flags);
  const mode_t mode = (flags & (O_CREAT | O_TMPFILE)) ? va_arg(more, mode_t) : 0;
  va_end(more);
  if (writes(flags) && !isDevice(path) && fails(Call::Open)) return -1;
  REAL(open64);
  return next(path, flags, mode);
}
int openat(int folder, const char* path, int flags, ...) {
  va_list more;
  va_start(more, flags);
  const mode_t mode = (flags & (O_CREAT | O_TMPFILE)) ? va_arg(more, mode_t) : 0;
  va_end(more);
  if (writes(flags) && !isDevice(path) && fails(Call::Open)) return -1;
  REAL(openat);
  return next(folder, path, flags, mode);
}
FILE* fopen(const char* path, const char* mode) {
  if (writes(mode) && !isDevice(path) && fails(Call::Open)) return nullptr;
  REAL(fopen);
  return next(path, mode);
}
FILE* fopen64(const char* path, const char* mode) {
  if (writes(mode) && !isDevice(path) && fails(Call::Open)) return nullptr;
  REAL(fopen64);
  return next(path, mode);
}

// ---- writes

ssize_t write(int fd, const void* data, size_t bytes) {
  REAL(write);
  const Action a = counted(fd) ? happens(Call::Write) : Action::None;
  if (a == Action::Once || a == Action::From) return errno = value, -1;
  return next(fd, data, a == Action::Short && bytes > 1 ? bytes / 2 : bytes);
}
ssize_t writev(int fd, const struct iovec* parts, int n) {
  REAL(writev);
  const Action a = counted(fd) ? happens(Call::Write) : Action::None;
  if (a == Action::Once || a == Action::From) return errno = value, -1;
  return next(fd, parts, a == Action::Short && n > 1 ? 1 : n);
}
ssize_t pwrite(int fd, const void* data, size_t bytes, off_t offset) {
  if (counted(fd) && fails(Call::Write)) return -1;
  REAL(pwrite);
  return next(fd, data, bytes, offset);
}
ssize_t pwrite64(int fd, const void* data, size_t bytes, off64_t offset) {
  if (counted(fd) && fails(Call::Write)) return -1;
  REAL(pwrite64);
  return next(fd, data, bytes, offset);
}
ssize_t sendfile(int out, int in, off_t* offset, size_t bytes) {
  if (counted(out) && fails(Call::Write)) return -1;
  REAL(sendfile);
  return next(out, in, offset, bytes);
}
ssize_t sendfile64(int out, int in, off64_t* offset, size_t bytes) {
  if (counted(out) && fails(Call::Write)) return -1;
  REAL(sendfile64);
  return next(out, in, offset, bytes);
}

/// The C library's streams write through calls of its own, so their functions are the ones that fail. Such a stream remembers an
/// error.
static bool streamFails(FILE* stream) {
  if (!stream || !counted(fileno(stream)) || !fails(Call::Write)) return false;
  stream->_flags |= 0x20;  // what ferror() looks at
  return true;
}
size_t fwrite(const void* data, size_t size, size_t n, FILE* stream) {
  if (streamFails(stream)) return 0;
  REAL(fwrite);
  return next(data, size, n, stream);
}
int fputs(const char* text, FILE* stream) {
  if (streamFails(stream)) return EOF;
  REAL(fputs);
  return next(text, stream);
}
int fflush(FILE* stream) {
  if (streamFails(stream)) return EOF;
  REAL(fflush);
  return next(stream);
}
int fclose(FILE* stream) {
  REAL(fclose);
  const bool failed = stream && (stream->_flags & 0x8) == 0 && streamFails(stream);  // 0x8: for reading only
  const int error = errno, result = next(stream);
  return failed ? (errno = error, EOF) : result;
}

// ---- names

int rename(const char* from, const char* to) {
  if (fails(Call::Rename)) return -1;
  REAL(rename);
  return next(from, to);
}
int renameat(int a, const char* from, int b, const char* to) {
  if (fails(Call::Rename)) return -1;
  REAL(renameat);
  return next(a, from, b, to);
}
int renameat2(int a, const char* from, int b, const char* to, unsigned flags) {
  if (fails(Call::Rename)) return -1;
  REAL(renameat2);
  return next(a, from, b, to, flags);
}
int link(const char* from, const char* to) {
  if (fails(Call::Rename)) return -1;
  REAL(link);
  return next(from, to);
}
int linkat(int a, const char* from, int b, const char* to, int flags) {
  if (fails(Call::Rename)) return -1;
  REAL(linkat);
  return next(a, from, b, to, flags);
}
int fsync(int fd) {
  if (fails(Call::Sync)) return -1;
  REAL(fsync);
  return next(fd);
}
int fdatasync(int fd) {
  if (fails(Call::Sync)) return -1;
  REAL(fdatasync);
  return next(fd);
}
int mkdir(const char* path, mode_t mode) {
  if (fails(Call::Folder)) return -1;
  REAL(mkdir);
  return next(path, mode);
}
int mkdirat(int folder, const char* path, mode_t mode) {
  if (fails(Call::Folder)) return -1;
  REAL(mkdirat);
  return next(folder, path, mode);
}
int unlink(const char* path) {
  if (fails(Call::Unlink)) return -1;
  REAL(unlink);
  return next(path);
}
int unlinkat(int folder, const char* path, int flags) {
  if (fails(Call::Unlink)) return -1;
  REAL(unlinkat);
  return next(folder, path, flags);
}
int remove(const char* path) {
  if (fails(Call::Unlink)) return -1;
  REAL(remove);
  return next(path);
}
int rmdir(const char* path) {
  if (fails(Call::Unlink)) return -1;
  REAL(rmdir);
  return next(path);
}

// ---- memory: through the C library's own names, because dlsym itself allocates

void* __libc_malloc(size_t);
void* __libc_calloc(size_t, size_t);
void* __libc_realloc(void*, size_t);
void* __libc_memalign(size_t, size_t);

static bool memoryFails(size_t bytes) {
  if (bytes < largeBytes || happens(Call::Memory) == Action::None) return false;
  errno = ENOMEM;
  return true;
}
void* malloc(size_t bytes) { return memoryFails(bytes) ? nullptr : __libc_malloc(bytes); }
void* calloc(size_t n, size_t size) {
  return size && n < SIZE_MAX / size && memoryFails(n * size) ? nullptr : __libc_calloc(n, size);
}
void* realloc(void* old, size_t bytes) { return memoryFails(bytes) ? nullptr : __libc_realloc(old, bytes); }
void* memalign(size_t alignment, size_t bytes) { return memoryFails(bytes) ? nullptr : __libc_memalign(alignment, bytes); }
void* aligned_alloc(size_t alignment, size_t bytes) { return memoryFails(bytes) ? nullptr : __libc_memalign(alignment, bytes); }
int posix_memalign(void** result, size_t alignment, size_t bytes) {
  void* memory = memoryFails(bytes) ? nullptr : __libc_memalign(alignment, bytes);
  if (!memory) return ENOMEM;
  *result = memory;
  return 0;
}
void* mmap(void* address, size_t bytes, int protection, int flags, int fd, off_t offset) {
  if ((flags & MAP_ANONYMOUS) && memoryFails(bytes)) return MAP_FAILED;
  REAL(mmap);
  return next(address, bytes, protection, flags, fd, offset);
}
void* mmap64(void* address, size_t bytes, int protection, int flags, int fd, off64_t offset) {
  if ((flags & MAP_ANONYMOUS) && memoryFails(bytes)) return MAP_FAILED;
  REAL(mmap64);
  return next(address, bytes, protection, flags, fd, offset);
}

int pthread_create(pthread_t* thread, const pthread_attr_t* attributes, void* (*run)(void*), void* argument) {
  if (fails(Call::Thread)) return EAGAIN;
  REAL(pthread_create);
  return next(thread, attributes, run, argument);
}

#pragma GCC visibility pop

}  // extern "C"
