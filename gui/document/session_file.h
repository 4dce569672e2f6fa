// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "core/app/session.h"
#include "gui/document/engine.h"

namespace glint::gui {

/// Opens a session (by its ending .glint, or the only one in a folder without a scene), an autosave, or any other input. What an
/// autosave says about where it is saved is believed only in this program's own folder (recoveryFolder); anywhere else it is a
/// session of its own, with a warning. A figure's session has no file to be saved to.
/// InputError; MissingScene and MissingMesh, to be asked again with where these are. A mesh that is given must be readable.
Opened openInput(const std::string& path, const Relinked& instead = {});
/// What the window shows, as a session keeps it.
SessionView viewOf(const Opened& opened);

/// Writes a session; InputError, Stopped. @param results  finished results of exactly this request, or null.
void saveSession(const Opened& opened, const Inspection* results, const std::string& path, const ProgressFn& progress = {});

/// As Engine::autosave.
void autosaveSession(const Opened& opened, const std::string& path);
/// What `autosaveSession` writes there: paths are relative to the folder of `path`.
std::string recoveryText(const Opened& opened, const std::string& path);

}  // namespace glint::gui
