// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QString>

class QWidget;

namespace glint::gui {

/// Shows below a box what is wrong with the typed text. It goes when the user types there again, or after some seconds;
/// a window shows one at a time, a QLabel named "complaint".
void complain(QWidget* box, const QString& words);

}  // namespace glint::gui
