// SPDX-License-Identifier: BSD-3-Clause
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>
#ifdef __linux__
#include <sys/prctl.h>
#endif

#include <array>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <sstream>
#include <thread>

#include "viz/offscreen.h"

namespace glint::viz {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::seconds kStartLimit{20};
constexpr std::chrono::seconds kStopLimit{5};

/// Full path of a program in PATH; "" if it is not installed.
std::string findProgram(const char* name) {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path ? path : "/usr/bin:/bin");
  for (std::string folder; std::getline(folders, folder, ':');) {
    const std::string file = (folder.empty() ? "." : folder) + "/" + name;
    if (access(file.c_str(), X_OK) == 0 && !std::filesystem::is_directory(file)) return file;
  }
  return {};
}

/// Ends exactly this child: politely, then by force.
void endProcess(int pid) {
  kill(pid, SIGTERM);
  const Clock::time_point limit = Clock::now() + kStopLimit;
  while (Clock::now() < limit) {
    const pid_t ended = waitpid(pid, nullptr, WNOHANG);
    if (ended == pid || (ended < 0 && errno != EINTR)) return;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  kill(pid, SIGKILL);
  while (waitpid(pid, nullptr, 0) < 0 && errno == EINTR) {
  }
}

/// What the server writes to -displayfd: its display number and a newline. "" if it ended or took too long.
std::string readNumber(int fd) {
  std::string text;
  const Clock::time_point limit = Clock::now() + kStartLimit;
  while (text.find('\n') == std::string::npos) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(limit - Clock::now()).count();
    if (left <= 0) return {};
    pollfd wait{fd, POLLIN, 0};
    const int ready = poll(&wait, 1, static_cast<int>(left));
    if (ready < 0 && errno == EINTR) continue;
    if (ready <= 0) return {};
    std::array<char, 32> buffer;
    const ssize_t n = read(fd, buffer.data(), buffer.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return {};
    text.append(buffer.data(), static_cast<std::size_t>(n));
  }
  return text.substr(0, text.find('\n'));
}

}  // namespace

Outcome<std::unique_ptr<VirtualDisplay>> VirtualDisplay::start(int width, int height) {
  const std::string program = findProgram("Xvfb");
  if (program.empty())
    return Failure{Reason::NotSupported, "3D rendering without a display needs Xvfb; install it: apt-get install xvfb"};
  std::array<int, 2> channel;
  if (pipe(channel.data()) != 0) return Failure{Reason::NotSupported, std::string("cannot start Xvfb: ") + std::strerror(errno)};
  const std::string fd = std::to_string(channel[1]), screen = std::to_string(width) + "x" + std::to_string(height) + "x24";
  const std::array<const char*, 11> arguments{program.c_str(), "-displayfd", fd.c_str(), "-screen",   "0",    screen.c_str(),
                                              "-nolisten",     "tcp",        "-noreset", "-nocursor", nullptr};
  const pid_t parent = getpid();
  const pid_t pid = fork();
  if (pid == 0) {  // between fork and exec only async-signal-safe calls
#ifdef __linux__
    prctl(PR_SET_PDEATHSIG, SIGTERM);  // so that no server is left when this program is killed
    if (getppid() != parent) _exit(127);
#endif
    // A blocked SIGTERM would be inherited, and the server could not be ended.
    sigset_t none;
    sigemptyset(&none);
    sigprocmask(SIG_SETMASK, &none, nullptr);
    close(channel[0]);
    // Ctrl-C is sent to the whole foreground group; the server must live until the window is gone.
    setpgid(0, 0);
    const int null = open("/dev/null", O_RDWR);
    if (null >= 0) {
      dup2(null, 0);
      dup2(null, 1);
      dup2(null, 2);
    }
    execv(program.c_str(), const_cast<char* const*>(arguments.data()));
    _exit(127);
  }
  close(channel[1]);
  const std::string number = pid > 0 ? readNumber(channel[0]) : std::string{};
  close(channel[0]);
  if (number.empty()) {
    if (pid > 0) endProcess(pid);
    return Failure{Reason::NotSupported, program + " did not start"};
  }
  std::unique_ptr<VirtualDisplay> display(new VirtualDisplay);
  display->pid_ = pid;
  display->name_ = ":" + number;
  if (const char* before = std::getenv("DISPLAY")) {
    display->previous_ = before;
    display->hadPrevious_ = true;
  }
  setenv("DISPLAY", display->name_.c_str(), 1);
  return display;
}

VirtualDisplay::~VirtualDisplay() {
  if (hadPrevious_) {
    setenv("DISPLAY", previous_.c_str(), 1);
  } else {
    unsetenv("DISPLAY");
  }
  endProcess(pid_);
}

}  // namespace glint::viz
