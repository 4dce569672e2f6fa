// SPDX-License-Identifier: BSD-3-Clause
#include "gui/base/tips.h"

#include <QTextDocument>
#include <QToolTip>
#include <QVariant>
#include <QWidget>

namespace glint::gui {

namespace {
const char* const kRich = "richTip";
}

QString plainTip(const QString& text) {
  if (!Qt::mightBeRichText(text)) return text;
  return QStringLiteral("<p style='white-space:pre-wrap'>%1</p>").arg(text.toHtmlEscaped());
}

void setRichTip(QWidget* widget, const QString& html) {
  widget->setProperty(kRich, html);  // of this very text: one that is set later is plain again
  widget->setToolTip(html);
}

bool hasRichTip(const QWidget* widget) { return widget->property(kRich).toString() == widget->toolTip(); }

void showTip(const QPoint& global, const QString& text, QWidget* widget) { QToolTip::showText(global, plainTip(text), widget); }

}  // namespace glint::gui
