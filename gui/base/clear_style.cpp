// SPDX-License-Identifier: BSD-3-Clause
#include "gui/base/clear_style.h"

#include <QAbstractScrollArea>
#include <QPainter>
#include <QPainterPath>
#include <QStyleFactory>
#include <QStyleOption>
#include <algorithm>

#include "gui/base/focus_frame.h"
#include "gui/base/theme.h"

namespace glint::gui {

namespace {
constexpr int kTabSpace = 14;  // left and right of a tab's title together: docks have many
QPalette::ColorGroup groupOf(const QStyleOption* option) {
  return option->state & QStyle::State_Enabled ? QPalette::Active : QPalette::Disabled;
}

void drawRing(const QRect& rect, QPainter* painter) {
  painter->save();
  painter->setRenderHint(QPainter::Antialiasing);
  painter->setPen(QPen(focusColour(), 2));
  painter->setBrush(Qt::NoBrush);
  painter->drawRoundedRect(QRectF(rect).adjusted(1, 1, -1, -1), 3, 3);
  painter->restore();
}

/// Round: a radio button's.
void drawIndicator(const QStyleOption* option, QPainter* painter, bool round) {
  const QPalette& palette = option->palette;
  const bool enabled = option->state & QStyle::State_Enabled;
  const bool on = option->state & QStyle::State_On, some = option->state & QStyle::State_NoChange;
  const int side = std::min(option->rect.width(), option->rect.height());
  QRectF box(0, 0, side - 1, side - 1);
  box.moveCenter(QRectF(option->rect).center());
  const QColor text = palette.color(groupOf(option), QPalette::Text);
  QColor edge = text;
  if (enabled && !(option->state & QStyle::State_MouseOver)) edge.setAlphaF(0.7);
  painter->save();
  painter->setRenderHint(QPainter::Antialiasing);
  const bool filled = enabled && (on || some);
  painter->setPen(QPen(filled ? accentColour() : edge, 1));
  painter->setBrush(filled ? accentColour() : palette.color(QPalette::Base));
  if (round)
    painter->drawEllipse(box);
  else
    painter->drawRoundedRect(box, 2, 2);
  const QColor mark = enabled ? QColor(Qt::white) : text;
  const auto at = [&box](double x, double y) { return QPointF(box.left() + x * box.width(), box.top() + y * box.height()); };
  if (on && round) {
    painter->setPen(Qt::NoPen);
    painter->setBrush(mark);
    painter->drawEllipse(box.center(), 0.22 * side, 0.22 * side);
  } else if (on) {
    QPainterPath tick(at(0.22, 0.52));
    tick.lineTo(at(0.42, 0.72));
    tick.lineTo(at(0.78, 0.28));
    painter->setBrush(Qt::NoBrush);
    painter->setPen(QPen(mark, std::max(1.5, side / 7.0), Qt::SolidLine, Qt::RoundCap, Qt::RoundJoin));
    painter->drawPath(tick);
  } else if (some) {
    painter->setPen(QPen(mark, 2));
    painter->drawLine(at(0.25, 0.5), at(0.75, 0.5));
  }
  painter->restore();
}
}  // namespace

ClearStyle::ClearStyle() : QProxyStyle(QStyleFactory::create(QStringLiteral("Fusion"))) {}

/// What scrolls draws no ring of its own, and a text that is only read has no cursor either.
void ClearStyle::polish(QWidget* widget) {
  QProxyStyle::polish(widget);
  if (qobject_cast<QAbstractScrollArea*>(widget) && widget->focusPolicy() & Qt::TabFocus &&
      !widget->findChild<FocusFrame*>(QString(), Qt::FindDirectChildrenOnly))
    new FocusFrame(widget);
}

void ClearStyle::drawPrimitive(PrimitiveElement element, const QStyleOption* option, QPainter* painter,
                               const QWidget* widget) const {
  switch (element) {
    case PE_IndicatorCheckBox:
    case PE_IndicatorItemViewItemCheck: return drawIndicator(option, painter, false);
    case PE_IndicatorRadioButton: return drawIndicator(option, painter, true);
    case PE_FrameFocusRect:
      // A click shows by itself where it went; only the keyboard needs the ring.
      if (option->state & State_KeyboardFocusChange) drawRing(option->rect, painter);
      return;
    case PE_FrameLineEdit:
      QProxyStyle::drawPrimitive(element, option, painter, widget);
      if (option->state & State_HasFocus) drawRing(option->rect, painter);
      return;
    default: return QProxyStyle::drawPrimitive(element, option, painter, widget);
  }
}

void ClearStyle::drawControl(ControlElement element, const QStyleOption* option, QPainter* painter, const QWidget* widget) const {
  QProxyStyle::drawControl(element, option, painter, widget);
  const State byKeyboard = State_HasFocus | State_KeyboardFocusChange;
  if (element == CE_PushButton && (option->state & byKeyboard) == byKeyboard) drawRing(option->rect, painter);
}

void ClearStyle::drawComplexControl(ComplexControl control, const QStyleOptionComplex* option, QPainter* painter,
                                    const QWidget* widget) const {
  QProxyStyle::drawComplexControl(control, option, painter, widget);
  const bool focus = option->state & State_HasFocus, byKeyboard = option->state & State_KeyboardFocusChange;
  if (focus && (control == CC_SpinBox || (control == CC_ComboBox && byKeyboard))) drawRing(option->rect, painter);
}

int ClearStyle::pixelMetric(PixelMetric metric, const QStyleOption* option, const QWidget* widget) const {
  return metric == PM_TabBarTabHSpace ? kTabSpace : QProxyStyle::pixelMetric(metric, option, widget);
}

int ClearStyle::styleHint(StyleHint hint, const QStyleOption* option, const QWidget* widget, QStyleHintReturn* result) const {
  return hint == SH_DialogButtonBox_ButtonsHaveIcons ? 0 : QProxyStyle::styleHint(hint, option, widget, result);
}

QIcon ClearStyle::standardIcon(StandardPixmap which, const QStyleOption* option, const QWidget* widget) const {
  return which == SP_ToolBarHorizontalExtensionButton ? icon(QStringLiteral("more"))
                                                      : QProxyStyle::standardIcon(which, option, widget);
}

}  // namespace glint::gui
