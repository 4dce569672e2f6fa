// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "tests/faults/injected.h"

namespace glint::faults {

/// One call that fails, see injected.h; none: the calls are only counted.
struct Fault {
  std::string call = "open", action;  ///< "write", "errno=28"
  int at = 0;
  std::string text() const { return call + ":" + std::to_string(at) + ":" + action; }
};

struct ChildRun {
  int code = -1;  ///< exit code; 128 + signal when a signal ended it
  bool signalled = false, timedOut = false;
  std::string out, err;
  std::vector<int> calls = std::vector<int>(kCalls);
  int injected = 0;
  double milliseconds = 0;
  int errorLines() const;
};

struct ChildOptions {
  std::optional<Fault> fault = {};  ///< counted and, with an action, injected
  std::map<std::string, std::string> environment = {};
  std::vector<int> cores = {};                  ///< the processor cores it may use; empty: all
  int secondsAtMost = 120;                      ///< then it hangs, and is killed
  std::optional<double> killAfterMs = {};       ///< SIGKILL at this time
  std::optional<double> interruptAfterMs = {};  ///< SIGINT or SIGTERM (`signal`) at this time
  int signal = 2;
};

/// Runs a program in a folder; its output goes to files, as a script does it.
ChildRun runChild(const std::vector<std::string>& command, const std::filesystem::path& folder, const ChildOptions& options);

/// One of the processor cores that this process may use: with it alone, the n-th call of a program is the same one every time.
int oneCore();

}  // namespace glint::faults
