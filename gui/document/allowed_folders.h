// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QString>
#include <QStringList>
#include <string>

#include "core/base/permitted.h"

namespace glint::gui {

// What a person allowed a session or scene to name outside of its own folders. It is kept with the program's settings, never in
// the file: a file from others cannot give itself rights.

/// Folders that `file` may name; empty if the user was not asked.
QStringList allowedFolders(const QString& file);
/// Remembers a yes. The oldest of several hundred is forgotten.
void allowFolder(const QString& file, const QString& folder);
/// The message without the flags of the command line that it names.
std::string withoutFlags(const OutsidePath& refused);

}  // namespace glint::gui
