// SPDX-License-Identifier: BSD-3-Clause
#include "cli/terminal.h"

#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <string>
#include <vector>

#include "cli/command.h"
#include "cli/interrupt.h"
#include "core/base/atomic_file.h"
#include "core/base/safe_text.h"

namespace glint::cli {
namespace {

std::mutex lineMutex;
bool lineShown = false;

bool onTerminal() {
  static const bool terminal = ::isatty(STDERR_FILENO) == 1;
  return terminal;
}

bool coloured() {
  static const bool wanted = [] {
    const char* const without = std::getenv("NO_COLOR");
    const char* const kind = std::getenv("TERM");
    return onTerminal() && !(without && *without) && kind && std::strcmp(kind, "dumb") != 0;
  }();
  return wanted;
}

void clearLocked() {
  if (!lineShown) return;
  std::fputs("\r\x1b[K", stderr);
  std::fflush(stderr);
  lineShown = false;
}

void toOutput(const std::string& text) {
  clearProgressLine();
  errno = 0;
  const bool written = std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0;
  if (!written && errno == EPIPE) throw ReaderGone{};
  if (!written) throw InputError("standard output", "", std::string("cannot be written: ") + std::strerror(errno));
}

std::vector<std::string> waiting;  // guarded by lineMutex
bool eachWarning = false;

}  // namespace

std::string programName(Tone tone) {
  if (tone == Tone::Info || !coloured()) return "glint:";
  return tone == Tone::Error ? "\x1b[1;31mglint:\x1b[0m" : "\x1b[1;33mglint:\x1b[0m";
}

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

void showEachWarning(bool each) { eachWarning = each; }

void dropWarnings() {
  const std::lock_guard<std::mutex> lock(lineMutex);
  waiting.clear();
}

void showWarnings() {
  const std::lock_guard<std::mutex> lock(lineMutex);
  if (waiting.empty()) return;
  clearLocked();
  if (waiting.size() == 1) {
    std::fprintf(stderr, "%s warning: %s\n", programName(Tone::Warning).c_str(), messageLine(waiting.front()).c_str());
  } else {
    // Each has its share of the line; what a short one leaves goes to those after it.
    constexpr std::size_t kFewest = 60;  // bytes: enough to say what a warning is about
    constexpr const char* kMore = "; more with --all-warnings";
    const std::string start = std::to_string(waiting.size()) + " warnings: ";
    std::size_t left = kLongestMessage - start.size() - std::strlen(kMore);
    std::string line;
    bool whole = true;
    for (std::size_t i = 0; i < waiting.size(); ++i) {
      if (left < kFewest) {
        whole = false;
        break;
      }
      const std::size_t share = std::max(kFewest, left / (waiting.size() - i)) - 3;  // the bar between two
      const std::string text = messageLine(waiting[i], share);
      whole = whole && text == messageLine(waiting[i], std::string::npos);
      line += (i ? " | " : "") + text;
      left -= std::min(left, text.size() + 3);
    }
    std::fprintf(stderr, "%s %s%s%s\n", programName(Tone::Warning).c_str(), start.c_str(), line.c_str(), whole ? "" : kMore);
  }
  waiting.clear();
}

void Context::warn(const std::string& line) const {
  const std::lock_guard<std::mutex> lock(lineMutex);
  if (!eachWarning) return waiting.push_back(line);
  clearLocked();
  std::fprintf(stderr, "%s warning: %s\n", programName(Tone::Warning).c_str(), messageLine(line).c_str());
}

void Context::info(const std::string& line) const {
  if (!onTerminal()) return;
  clearProgressLine();
  std::fprintf(stderr, "glint: info: %s\n", messageLine(line).c_str());
}

void Context::print(const std::string& text) const { toOutput(withoutControls(text)); }

void Context::write(const std::string& fileOrDash, const std::string& content) const {
  if (fileOrDash == "-") return toOutput(content);
  atomicWrite(fileOrDash, content);
  wrote(fileOrDash);
}

void Context::wrote(const std::string& file) const {
  if (!onTerminal()) return;
  clearProgressLine();
  std::fprintf(stderr, "%s wrote %s\n", programName(Tone::Info).c_str(), messageLine(file).c_str());
}

}  // namespace glint::cli
