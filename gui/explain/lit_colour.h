// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QColor>

#include "core/draw/colours.h"
#include "gui/base/theme.h"

namespace glint::gui {

/// Colour of the symbol that the user points at, and of what it stands for in the 3D view.
inline QColor litColour() { return toQColor(currentTheme() == Theme::Dark ? draw::kLitOnDark : draw::kLitOnLight); }

}  // namespace glint::gui
