// SPDX-License-Identifier: BSD-3-Clause
#include "cli/commands.h"

int main(int argc, char** argv) {
  using namespace glint::cli;
  // The order is that of `glint --help`; one command a line, so that two additions merge.
  return runCommandLine(argc, argv,
                        {
                            infoCommand(),
                            detectCommand(),
                            reconstructCommand(),
                            predictCommand(),
                            evaluateCommand(),
                            tradeoffCommand(),
                            synthCommand(),
                            convertCommand(),
                            renderCommand(),
                            movieCommand(),
                            replayCommand(),
                            compareCommand(),
                            stabilityCommand(),
                            settingsCommand(),
                        });
}
