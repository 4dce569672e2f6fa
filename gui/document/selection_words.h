// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QString>

#include "core/draw/selection.h"
#include "core/scene/scene.h"

namespace glint::gui {

/// What a selection was about, for the undo history: "Select limit-angle", "Select highlight 2 in frame 0003", "Select frame
/// 0004". What was chosen counts; what was only given up ("no highlight any more") is named if nothing was chosen.
QString selectionWords(const draw::Selection& before, const draw::Selection& after, const Scene& scene);

}  // namespace glint::gui
