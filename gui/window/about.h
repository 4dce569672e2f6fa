// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QString>

class QWidget;

namespace glint::gui {

/// Version, purpose, licence and the plugins that are loaded, as plain text: what the dialog shows and copies.
QString aboutText();
/// Shows it until it is closed.
void showAbout(QWidget* parent);

}  // namespace glint::gui
