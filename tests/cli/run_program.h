// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>
#include <sstream>
#include <string>

#include "tests/core/scene/scene_fixture.h"

namespace glint::testing_support {

struct ProgramRun {
  int code = -1;  ///< exit code; 128 + signal when it was killed
  std::string out, err;
  int errorLines() const { return static_cast<int>(std::count(err.begin(), err.end(), '\n')); }
};

/// The number that begins there, with a decimal point whatever the locale.
inline double numberAt(const std::string& text, std::size_t at) {
  double number = 0;
  std::istringstream(text.substr(at)) >> number;
  return number;
}

/// Runs `glint ARGUMENTS` through the shell, its standard error in a file (so it is no terminal). `before` is put before
/// the program: "ulimit -f 1;". The arguments may redirect standard output.
inline ProgramRun runGlint(const std::string& arguments, const std::string& before = "") {
  const TemporaryFolder folder;
  const std::string out = (folder / "out").string(), err = (folder / "err").string();
  const int status =
      std::system(("(" + before + " '" GLINT_PROGRAM "' " + arguments + ") >'" + out + "' 2>'" + err + "'").c_str());
  ProgramRun run;
  run.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  run.out = contentOf(out);
  run.err = contentOf(err);
  return run;
}

}  // namespace glint::testing_support
