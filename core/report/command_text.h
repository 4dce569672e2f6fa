// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "core/inspect/inspection.h"

namespace glint {

/// The command line that computes a request: `glint evaluate INPUT …`, quoted for a POSIX shell; settings at their defaults are
/// left out. INPUT is the scene's file; where its photographs and meshes were looked for is named, too. All paths are absolute,
/// so that it works in any folder. NotSupported for what has no flag (a what-if): only a session can hold it.
Outcome<std::string> commandOf(const Scene& scene, const InspectionRequest& request);

/// The text as one word of a POSIX shell.
std::string shellWord(const std::string& text);

}  // namespace glint
