// SPDX-License-Identifier: BSD-3-Clause
#include "cli/terminal.h"

#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <mutex>

#include "cli/command.h"
#include "cli/interrupt.h"
#include "core/base/atomic_file.h"

namespace glint::cli {
namespace {

std::mutex lineMutex;
bool lineShown = false;

bool onTerminal() {
  static const bool terminal = ::isatty(STDERR_FILENO) == 1;
  return terminal;
}

void clearLocked() {
  if (!lineShown) return;
  std::fputs("\r\x1b[K", stderr);
  std::fflush(stderr);
  lineShown = false;
}

spdlog::logger& logger() {
  static const std::shared_ptr<spdlog::logger> log = [] {
    auto made = std::make_shared<spdlog::logger>("glint", std::make_shared<spdlog::sinks::stderr_sink_mt>());
    made->set_pattern("%n: %l: %v");
    return made;
  }();
  return *log;
}

}  // namespace

void clearProgressLine() {
  const std::lock_guard<std::mutex> lock(lineMutex);
  clearLocked();
}

ProgressFn Context::progress() const {
  return [last = std::chrono::steady_clock::time_point()](const StageEvent& event) mutable {
    const auto now = std::chrono::steady_clock::now();
    if (onTerminal() && now - last > std::chrono::milliseconds(100)) {
      last = now;
      const std::lock_guard<std::mutex> lock(lineMutex);
      if (event.total > 0)
        std::fprintf(stderr, "\r\x1b[K%s %d of %d", event.stage.c_str(), event.done, event.total);
      else
        std::fprintf(stderr, "\r\x1b[K%s ...", event.stage.c_str());
      std::fflush(stderr);
      lineShown = true;
    }
    return !interrupted();
  };
}

void Context::warn(const std::string& line) const {
  clearProgressLine();
  logger().warn("{}", line);
}

void Context::info(const std::string& line) const {
  if (!onTerminal()) return;
  clearProgressLine();
  logger().info("{}", line);
}

void Context::print(const std::string& text) const {
  clearProgressLine();
  errno = 0;
  const bool written = std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0;
  if (!written && errno == EPIPE) throw ReaderGone{};
  if (!written) throw InputError("standard output", "", std::string("cannot be written: ") + std::strerror(errno));
}

void Context::write(const std::string& fileOrDash, const std::string& content) const {
  if (fileOrDash == "-") return print(content);
  atomicWrite(fileOrDash, content);
}

}  // namespace glint::cli
