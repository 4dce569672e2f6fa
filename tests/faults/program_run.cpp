// SPDX-License-Identifier: BSD-3-Clause
#include "tests/faults/program_run.h"

#include <fcntl.h>
#include <sched.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <new>
#include <thread>

#include "tests/core/scene/scene_fixture.h"

extern char** environ;

namespace glint::faults {

namespace {

using Clock = std::chrono::steady_clock;
using testing_support::TemporaryFolder;

std::vector<std::string> environmentOf(const ChildOptions& options, const std::filesystem::path& countsFile,
                                       const std::string& program) {
  std::map<std::string, std::string> all;
  for (char** e = environ; *e; ++e) {
    const std::string text = *e;
    if (const std::size_t equals = text.find('='); equals != std::string::npos)
      all[text.substr(0, equals)] = text.substr(equals + 1);
  }
  for (const auto& [name, value] : options.environment) all[name] = value;
  if (options.fault) {
    all["LD_PRELOAD"] = GLINT_INJECT + (all["LD_PRELOAD"].empty() ? "" : ":" + all["LD_PRELOAD"]);
    all["GLINT_FAULT_COUNTS"] = countsFile.string();
    all["GLINT_FAULT_PROGRAM"] = program;
    all["GLINT_FAULT"] = options.fault->text();
  }
  std::vector<std::string> texts;
  for (const auto& [name, value] : all) texts.push_back(name + "=" + value);
  return texts;
}

std::vector<char*> pointers(std::vector<std::string>& texts) {
  std::vector<char*> all;
  for (std::string& text : texts) all.push_back(text.data());
  all.push_back(nullptr);
  return all;
}

/// The calls as the program counted them; the file is mapped by both.
class CountsFile {
 public:
  explicit CountsFile(const std::filesystem::path& file) {
    const int fd = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
    if (::ftruncate(fd, sizeof(Counts)) != 0) std::abort();
    void* memory = ::mmap(nullptr, sizeof(Counts), PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
    ::close(fd);
    if (memory == MAP_FAILED) std::abort();
    counts_ = new (memory) Counts{};
  }
  ~CountsFile() { ::munmap(counts_, sizeof(Counts)); }
  CountsFile(const CountsFile&) = delete;
  CountsFile& operator=(const CountsFile&) = delete;
  const Counts& operator*() const { return *counts_; }

 private:
  Counts* counts_;
};

}  // namespace

int oneCore() {
  cpu_set_t allowed;
  CPU_ZERO(&allowed);
  ::sched_getaffinity(0, sizeof allowed, &allowed);
  int core = 0;
  while (core < CPU_SETSIZE - 1 && !CPU_ISSET(core, &allowed)) ++core;
  return core;
}

int ChildRun::errorLines() const { return static_cast<int>(std::count(err.begin(), err.end(), '\n')); }

ChildRun runChild(const std::vector<std::string>& command, const std::filesystem::path& folder, const ChildOptions& options) {
  const TemporaryFolder own;
  const CountsFile counts(own / "counts");
  std::vector<std::string> arguments = command,
                           environment =
                               environmentOf(options, own / "counts", std::filesystem::path(command[0]).filename().string());
  const std::vector<char*> argv = pointers(arguments), envp = pointers(environment);
  const std::string out = (own / "out").string(), err = (own / "err").string(), home = folder.string();
  cpu_set_t cores;
  CPU_ZERO(&cores);
  for (const int core : options.cores) CPU_SET(core, &cores);
  const Clock::time_point start = Clock::now();
  const pid_t pid = ::fork();
  if (pid == 0) {  // only async-signal-safe calls
    const int in = ::open("/dev/null", O_RDONLY), o = ::open(out.c_str(), O_WRONLY | O_CREAT, 0600),
              e = ::open(err.c_str(), O_WRONLY | O_CREAT, 0600);
    if (::dup2(in, 0) < 0 || ::dup2(o, 1) < 0 || ::dup2(e, 2) < 0 || ::chdir(home.c_str()) != 0) ::_exit(126);
    if (!options.cores.empty() && ::sched_setaffinity(0, sizeof cores, &cores) != 0) ::_exit(126);
    ::setpgid(0, 0);
    ::execve(argv[0], argv.data(), envp.data());
    ::_exit(127);
  }
  ChildRun run;
  int status = 0;
  const auto passed = [&] { return std::chrono::duration<double, std::milli>(Clock::now() - start).count(); };
  bool killed = false, interrupted = false;
  double since = 0;
  while (::waitpid(pid, &status, WNOHANG) == 0) {
    if (options.killAfterMs && !killed && passed() >= *options.killAfterMs) {
      ::kill(pid, SIGKILL);
      killed = true;
    }
    if (options.interruptAfterMs && !interrupted && passed() >= *options.interruptAfterMs) {
      since = passed();
      ::kill(pid, options.signal);
      interrupted = true;
    }
    if (passed() > 1000.0 * options.secondsAtMost) {
      run.timedOut = true;
      ::kill(pid, SIGKILL);
    }
    std::this_thread::sleep_for(std::chrono::microseconds(500));
  }
  run.milliseconds = passed() - since;
  run.signalled = WIFSIGNALED(status);
  run.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  run.out = testing_support::contentOf(out);
  run.err = testing_support::contentOf(err);
  for (int i = 0; i < kCalls; ++i) run.calls[static_cast<std::size_t>(i)] = (*counts).calls[i];
  run.injected = (*counts).injected;
  return run;
}

}  // namespace glint::faults
