// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/base/words.h"
#include "gui/base/text.h"

namespace glint::gui {

inline QString unitAfter(const std::string& unit) { return toQString(unitAfterNumber(unit)); }

}  // namespace glint::gui
