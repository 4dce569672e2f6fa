// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "gui/base/text.h"

namespace glint::gui {

/// A unit as the window writes it: terminals and files get plain ASCII.
inline QString unitText(const std::string& unit) {
  return unit == "px^2" ? QStringLiteral("px²") : unit == "deg" ? QStringLiteral("°") : toQString(unit);
}

}  // namespace glint::gui
