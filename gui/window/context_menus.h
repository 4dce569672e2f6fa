// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "gui/base/actions.h"

namespace glint::gui {

class ErrorTable;
class FramePanel;
class PlotsPanel;

/// A click with the right button on a photograph, a plot or the errors: what one does there most.
void offerMenus(const Actions& actions, FramePanel& frame, PlotsPanel& plots, ErrorTable& errors);

}  // namespace glint::gui
