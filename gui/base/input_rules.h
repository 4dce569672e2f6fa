// SPDX-License-Identifier: BSD-3-Clause
#pragma once

class QApplication;

namespace glint::gui {

/// What holds for every widget of the program, in one place:
/// - A label shows plain text unless it says that its text is rich: names and messages from files are never markup.
/// - A tool tip is plain text unless it was set by setRichTip.
/// - Screen readers call a button without words, a list and a slider by its tool tip, unless it has a name.
/// - The wheel changes a number box, a combo box or a slider only if it has the focus (was clicked); else it scrolls the panel.
void installInputRules(QApplication& app);

}  // namespace glint::gui
