// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QString>

#include "gui/document/document.h"

namespace glint::gui {

/// What a document is called in the title of its window: its scene's name, and the session's file if its name differs:
/// "vase", "vase (run.glint)". The file alone where the scene has no name.
QString titleOf(const Document& document);

}  // namespace glint::gui
