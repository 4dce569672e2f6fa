// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "gui/base/actions.h"
#include "gui/document/document.h"
#include "gui/window/palette.h"

namespace glint::gui {

/// Where the palette leads: brings the row of a key in sight, ready for keys.
struct PaletteTargets {
  std::function<void(const std::string&key)> parameter, whatIf;
  std::function<int()> activeView = [] { return 0; };  ///< whose layers are meant
};

/// What the palette offers for the typed text: actions, layers of the active 3D view, parameters and knobs of the what-if with
/// their values; for a number frames, too; and for "name = value" the parameters and knobs with that value, to be set at once.
QList<PaletteItem> paletteItems(const QString& typed, const Actions& actions, Document& document, const PaletteTargets& targets);

}  // namespace glint::gui
