// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "gui/base/actions.h"

namespace glint::gui {

class ErrorTable;
class FramePanel;
class PlotsPanel;

/// Menus of the right mouse button on a photograph, a plot or the errors: the most frequent actions there.
void offerMenus(const Actions& actions, FramePanel& frame, PlotsPanel& plots, ErrorTable& errors);

}  // namespace glint::gui
