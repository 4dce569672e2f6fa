// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QString>

#include "gui/document/document.h"

class QMenu;

namespace glint::gui {

/// "training", "held out", "excluded".
QString roleName(FrameRole role);
/// Frames that are excluded in what is shown: by the request, or in the pinned results while those are.
const std::vector<int>& shownExcluded(const Document& document);
/// The three roles of a frame as choices of a menu, that which it has ticked.
void addRoles(QMenu& menu, Document& document, int frame);

}  // namespace glint::gui
