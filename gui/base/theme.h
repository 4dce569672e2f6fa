// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QColor>
#include <QIcon>
#include <QString>

#include "viz/style.h"

class QApplication;

namespace glint::gui {

enum class Theme { Light, Dark };

/// Sets style, palette and style sheet of the whole program; icons made afterwards match.
void applyTheme(QApplication& app, Theme theme);
Theme currentTheme();
/// The user's last choice, in this run or an earlier one; dark without a choice.
Theme keptTheme();
void keepTheme(Theme theme);
/// One of resources/icons in the theme's text colour, with a faded disabled state. Sharp at every device pixel ratio.
QIcon icon(const QString& name);

QColor accentColour();
QColor focusColour();    ///< the ring around what the keyboard acts on
QColor warningColour();  ///< amber: stale, out of date
QColor errorColour();
QColor toQColor(const draw::Colour& c);
/// Square of the model's fixed colour, for lists and legends.
QIcon colourSwatch(const QColor& colour);

}  // namespace glint::gui
