// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QPoint>
#include <QString>

class QWidget;

namespace glint::gui {

/// A tool tip that shows this text as it is. Qt takes whatever looks like markup for markup, and would load a picture that a
/// file's name asks for.
QString plainTip(const QString& text);
/// A tool tip whose markup is the program's own; text from elsewhere is escaped in it. Any other tool tip of a widget
/// is shown as plain text (see installInputRules).
void setRichTip(QWidget* widget, const QString& html);
bool hasRichTip(const QWidget* widget);
/// QToolTip::showText, as plain text.
void showTip(const QPoint& global, const QString& text, QWidget* widget);

}  // namespace glint::gui
