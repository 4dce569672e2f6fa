// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "cli/command.h"

namespace glint::cli {

// One function per subcommand, each in the file of its name; main.cpp lists them.
Command compareCommand();
Command convertCommand();
Command detectCommand();
Command diagnoseCommand();
Command evaluateCommand();
Command infoCommand();
Command lightsCommand();
Command movieCommand();
Command renderCommand();
Command predictCommand();
Command reconstructCommand();
Command replayCommand();
Command retextureCommand();
Command settingsCommand();
Command shareCommand();
Command synthCommand();
Command textureCommand();
Command tradeoffCommand();

}  // namespace glint::cli
