// SPDX-License-Identifier: BSD-3-Clause
#include "gui/base/focus_frame.h"

#include <QFocusEvent>
#include <QPainter>

#include "gui/base/theme.h"

namespace glint::gui {

FocusFrame::FocusFrame(QWidget* of) : QWidget(of) {
  setAttribute(Qt::WA_TransparentForMouseEvents);
  hide();
  of->installEventFilter(this);
}

bool FocusFrame::eventFilter(QObject* watched, QEvent* event) {
  const auto reason = [&] { return static_cast<const QFocusEvent*>(event)->reason(); };  // of a focus event only
  const auto elsewhere = [&] {                                                           // another window, a menu: it comes back
    return reason() == Qt::ActiveWindowFocusReason || reason() == Qt::PopupFocusReason;
  };
  switch (event->type()) {
    case QEvent::FocusIn:
      if (!elsewhere()) byKeyboard_ = reason() == Qt::TabFocusReason || reason() == Qt::BacktabFocusReason;
      if (byKeyboard_) {
        setGeometry(parentWidget()->rect());
        raise();
      }
      setVisible(byKeyboard_);
      break;
    case QEvent::FocusOut:
      if (!elsewhere()) byKeyboard_ = false;
      hide();
      break;
    case QEvent::MouseButtonPress:  // a click shows by itself where it went
      byKeyboard_ = false;
      hide();
      break;
    case QEvent::Resize: setGeometry(parentWidget()->rect()); break;
    default: break;
  }
  return QWidget::eventFilter(watched, event);
}

void FocusFrame::paintEvent(QPaintEvent*) {
  QPainter painter(this);
  painter.setPen(QPen(focusColour(), 2));
  painter.drawRect(QRectF(rect()).adjusted(1, 1, -1, -1));
}

}  // namespace glint::gui
