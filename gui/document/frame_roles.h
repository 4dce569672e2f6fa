// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QString>

#include "gui/document/document.h"

class QMenu;

namespace glint::gui {

/// "training", "held out", "excluded".
QString roleName(FrameRole role);
/// The three roles of a frame as choices of a menu, that which it has ticked.
void addRoles(QMenu& menu, Document& document, int frame);

}  // namespace glint::gui
