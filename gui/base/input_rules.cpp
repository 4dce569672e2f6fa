// SPDX-License-Identifier: BSD-3-Clause
#include "gui/base/input_rules.h"

#include <QAbstractButton>
#include <QAbstractSlider>
#include <QAbstractSpinBox>
#include <QApplication>
#include <QComboBox>
#include <QEvent>
#include <QLabel>
#include <QRegularExpression>
#include <QScrollBar>
#include <QTextDocument>
#include <QTextDocumentFragment>

#include "gui/base/tips.h"

namespace glint::gui {

namespace {
bool holdsAValue(const QObject* o) {
  return qobject_cast<const QAbstractSpinBox*>(o) || qobject_cast<const QComboBox*>(o) ||
         (qobject_cast<const QAbstractSlider*>(o) && !qobject_cast<const QScrollBar*>(o));
}

/// What a tip says first: "Play walk" of "Play walk (W)".
QString nameIn(const QString& tip) {
  const QString text = Qt::mightBeRichText(tip) ? QTextDocumentFragment::fromHtml(tip).toPlainText() : tip;
  static const QRegularExpression end(QStringLiteral("\n|: |; |\\. | \\("));
  return text.section(end, 0, 0).trimmed();
}

/// What has no words of its own is called by its tip, even when that changes. A given name stays.
void nameByTip(QWidget* widget) {
  const auto* button = qobject_cast<const QAbstractButton*>(widget);
  const bool wordless = button ? button->text().isEmpty() : holdsAValue(widget) && !qobject_cast<const QAbstractSpinBox*>(widget);
  constexpr const char* kOwn = "nameByTip";
  if (!wordless || (!widget->accessibleName().isEmpty() && widget->accessibleName() != widget->property(kOwn).toString())) return;
  widget->setAccessibleName(nameIn(widget->toolTip()));
  widget->setProperty(kOwn, widget->accessibleName());
}

class InputRules : public QObject {
 public:
  using QObject::QObject;

 protected:
  bool eventFilter(QObject* watched, QEvent* event) override {
    switch (event->type()) {
      case QEvent::Polish: polish(watched); break;
      case QEvent::ToolTipChange:
        if (auto* widget = qobject_cast<QWidget*>(watched)) {
          nameByTip(widget);
          if (!hasRichTip(widget) && Qt::mightBeRichText(widget->toolTip())) setRichTip(widget, plainTip(widget->toolTip()));
        }
        break;
      case QEvent::Wheel:
        if (holdsAValue(watched) && !static_cast<QWidget*>(watched)->hasFocus()) {
          event->ignore();  // goes on to the panel that it lies in
          return true;
        }
        break;
      default: break;
    }
    return QObject::eventFilter(watched, event);
  }

 private:
  static void polish(QObject* watched) {
    // plainTip and setRichTip write the tool tips' label. Its class tells it, because it is polished before it has a name.
    if (auto* label = qobject_cast<QLabel*>(watched);
        label && label->textFormat() == Qt::AutoText && !label->inherits("QTipLabel"))
      label->setTextFormat(Qt::PlainText);
    // The wheel would give the focus first, and change the value then.
    if (holdsAValue(watched))
      if (auto* widget = static_cast<QWidget*>(watched); widget->focusPolicy() == Qt::WheelFocus)
        widget->setFocusPolicy(Qt::StrongFocus);
  }
};
}  // namespace

void installInputRules(QApplication& app) { app.installEventFilter(new InputRules(&app)); }

}  // namespace glint::gui
