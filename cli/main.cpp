// SPDX-License-Identifier: BSD-3-Clause
#include "cli/commands.h"
#include "cli/interrupt.h"

int main(int argc, char** argv) {
  using namespace glint::cli;
  // First of all: a Ctrl-C from here on ends the program in its own way, and threads inherit the blocked signals.
  const InterruptGuard interrupts;
  // The order is that of `glint --help`; one command a line, so that two additions merge.
  const int code = runCommandLine(argc, argv, [] {
    // clang-format off
    return std::vector<Command>{
        infoCommand(),
        detectCommand(),
        reconstructCommand(),
        predictCommand(),
        retextureCommand(),
        textureCommand(),
        evaluateCommand(),
        diagnoseCommand(),
        tradeoffCommand(),
        lightsCommand(),
        synthCommand(),
        convertCommand(),
        renderCommand(),
        movieCommand(),
        shareCommand(),
        replayCommand(),
        compareCommand(),
        settingsCommand(),
    };
    // clang-format on
  });
  if (interrupted()) leaveAtOnce(code);
  return code;
}
