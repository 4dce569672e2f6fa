// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

namespace glint {

/// Equal for names of files (UTF-8) that people take for the same: in small letters (Latin, Greek, Cyrillic), each accent as a
/// mark of its own. Systems disagree about both: Windows and macOS find "IMG.PNG" as "img.png", and macOS hands out an accent
/// apart from its letter. Bytes that are no UTF-8 stand for themselves.
std::u32string fileNameKey(std::string_view name);

}  // namespace glint
