// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace glint::gui {

/// One line on standard error, with the program's name before it, escaped and shortened as messageLine does it.
void printErrorLine(const std::string& text);

}  // namespace glint::gui
