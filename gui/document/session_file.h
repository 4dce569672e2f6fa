// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "gui/document/engine.h"

namespace glint::gui {

/// Opens a session (by its ending .glint, or the only one in a folder without a scene) or any other input. InputError.
Opened openInput(const std::string& path);
/// Writes a session; InputError, Stopped. @param results  finished results of exactly this request, or null.
void saveSession(const Opened& opened, const Inspection* results, const std::string& path, const ProgressFn& progress = {});

}  // namespace glint::gui
