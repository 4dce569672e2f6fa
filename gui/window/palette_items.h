// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "gui/base/actions.h"
#include "gui/document/document.h"
#include "gui/window/palette.h"

namespace glint::gui {

/// What the palette offers for what is typed: every action, every parameter with its value, the frames once a number is typed,
/// and for "name = value" the parameters with that value, to be set at once.
/// @param showParameter  brings a parameter's row in sight, ready for keys.
QList<PaletteItem> paletteItems(const QString& typed, const Actions& actions, Document& document,
                                const std::function<void(const std::string& key)>& showParameter);

}  // namespace glint::gui
