// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>

#include "gui/document/runner.h"
#include "gui/window/message_bar.h"

class QWidget;

namespace glint::gui {

/// Shows a message with buttons for what the files leave undecided: one for each answer, and one that asks for a mesh, for poses
/// or for intrinsics. A user who cancels such a question finds the message there again.
/// @param open  opens the input, or the folder inside it that is meant, with this in addition
void askIn(MessageBar& bar, const QString& oneLine, const UndecidedPtr& undecided, QWidget* window,
           const std::function<void(const QString& path, const Relinked&)>& open);

}  // namespace glint::gui
