// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QProxyStyle>

namespace glint::gui {

/// Fusion with narrower tabs, an arrow of more tools in the theme's colour, and with check boxes and a keyboard focus that stand
/// out from the background at least 3 : 1 in both themes (Web Content Accessibility Guidelines 2.1, 1.4.11): Fusion derives their
/// lines from the background, which a dark one swallows.
class ClearStyle : public QProxyStyle {
 public:
  ClearStyle();
  using QProxyStyle::polish;
  void polish(QWidget* widget) override;
  void drawPrimitive(PrimitiveElement element, const QStyleOption* option, QPainter* painter,
                     const QWidget* widget) const override;
  void drawComplexControl(ComplexControl control, const QStyleOptionComplex* option, QPainter* painter,
                          const QWidget* widget) const override;
  void drawControl(ControlElement element, const QStyleOption* option, QPainter* painter, const QWidget* widget) const override;
  int pixelMetric(PixelMetric metric, const QStyleOption* option, const QWidget* widget) const override;
  int styleHint(StyleHint hint, const QStyleOption* option, const QWidget* widget, QStyleHintReturn* result) const override;
  QIcon standardIcon(StandardPixmap which, const QStyleOption* option, const QWidget* widget) const override;
};

}  // namespace glint::gui
