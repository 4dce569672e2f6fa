// SPDX-License-Identifier: BSD-3-Clause
#include "gui/base/error_line.h"

#include <cstdio>

#include "core/base/safe_text.h"

namespace glint::gui {

void printErrorLine(const std::string& text) { std::fprintf(stderr, "glint-inspector: %s\n", messageLine(text).c_str()); }

}  // namespace glint::gui
