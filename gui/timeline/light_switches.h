// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "gui/document/document.h"
#include "viz/timeline_data.h"

class QMenu;

namespace glint::gui {

/// Lights on and off, frame by frame: offered by the timeline's rows, its menus and the palette. A change is one step of undo.

/// "on", "switched off by hand", ...
QString lightStateText(viz::LightState state);
/// What a click on it does, or why it does nothing.
QString lightClickText(const Document& document, viz::LightState state);
/// What a click would do; false for a light that was off as captured while no contours are synthesised: nothing shows it lit.
bool canSwitch(const Document& document, viz::LightState state);
/// Off if it is on (or nothing says that it is not), else on. Does nothing if it cannot.
void switchLight(Document& document, const viz::LightRow& row, int frame);
/// All frames at once: off where it could be on, or every frame as captured.
void switchLightEverywhere(Document& document, const viz::LightRow& row, bool asCaptured);
/// A ticked entry for each light of the frame; if there is only one, an entry that says why.
void addLights(QMenu& menu, Document& document, const std::vector<viz::LightRow>& rows, int frame);

}  // namespace glint::gui
