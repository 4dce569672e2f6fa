// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QObject>
#include <functional>

namespace glint::gui {

/// Lets views draw one after the other, each in a turn of the event loop of its own, when nothing else waits there: a window with
/// five views stands still for the slowest of them and not for their sum, and what the user does in between comes first.
///
/// Asked again before its turn, an owner draws once, with what it asked for last. One that is deleted loses its turn.
void drawInTurn(QObject* owner, std::function<void()> draw);

/// A view waits for a turn.
bool drawingsWait();

}  // namespace glint::gui
