// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace glint::gui {

/// How the window's process handles memory: it keeps what it frees, for the next image; it keeps decoded images, since each
/// change of a detection's setting looks at all frames again; and it has what task schedulers need. Call it first.
/// @throw std::bad_alloc
void applyMemoryRules();

}  // namespace glint::gui
