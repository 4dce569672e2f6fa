// SPDX-License-Identifier: BSD-3-Clause
#include "gui/base/theme.h"

#include <QApplication>
#include <QFile>
#include <QIconEngine>
#include <QPainter>
#include <QPalette>
#include <QPixmap>
#include <QSettings>
#include <QSvgRenderer>

#include "core/draw/contrast.h"
#include "gui/base/clear_style.h"

// The icons are compiled into a static library: without this call the linker leaves them out. Must be outside of namespaces.
static void initIcons() { Q_INIT_RESOURCE(icons); }

namespace glint::gui {

namespace {
const char *const kThemeKey = "theme", *const kLight = "light", *const kDark = "dark";
Theme theTheme = Theme::Dark;

QByteArray svg(const QString& name, const QColor& colour) {
  QFile file(QStringLiteral(":/icons/%1.svg").arg(name));
  if (!file.open(QIODevice::ReadOnly)) return {};
  return file.readAll().replace("#000", colour.name().toUtf8());
}

/// Draws the SVG at whatever size and pixel ratio is asked for, in the palette's colours of that moment,
/// so that a change of theme needs no new icons.
class SvgIconEngine : public QIconEngine {
 public:
  explicit SvgIconEngine(QString name) : name_(std::move(name)) {}
  void paint(QPainter* painter, const QRect& rect, QIcon::Mode mode, QIcon::State) override {
    const QPalette palette = QApplication::palette();
    const auto group = mode == QIcon::Disabled ? QPalette::Disabled : QPalette::Active;
    QSvgRenderer renderer(svg(name_, palette.color(group, QPalette::ButtonText)));
    renderer.render(painter, QRectF(rect));
  }
  QPixmap pixmap(const QSize& size, QIcon::Mode mode, QIcon::State state) override {
    QPixmap picture(size);
    picture.fill(Qt::transparent);
    QPainter painter(&picture);
    paint(&painter, QRect(QPoint(0, 0), size), mode, state);
    return picture;
  }
  QIconEngine* clone() const override { return new SvgIconEngine(name_); }

 private:
  QString name_;
};

QPalette palette(Theme theme) {
  const bool dark = theme == Theme::Dark;
  const QColor window = dark ? QColor(0x2a, 0x2c, 0x2f) : QColor(0xf2, 0xf3, 0xf4);
  const QColor base = dark ? QColor(0x1f, 0x21, 0x23) : QColor(0xff, 0xff, 0xff);
  const QColor text = dark ? QColor(0xdc, 0xde, 0xe0) : QColor(0x22, 0x25, 0x28);
  const QColor faded = dark ? QColor(0x93, 0x99, 0x9f) : QColor(0x67, 0x6d, 0x73);  // 4.5 : 1, it is read
  const QColor disabled = dark ? QColor(0x74, 0x79, 0x7e) : QColor(0x9a, 0x9f, 0xa5);
  QPalette p;
  p.setColor(QPalette::Window, window);
  p.setColor(QPalette::WindowText, text);
  p.setColor(QPalette::Base, base);
  p.setColor(QPalette::AlternateBase, dark ? QColor(0x24, 0x26, 0x29) : QColor(0xf7, 0xf8, 0xf9));
  p.setColor(QPalette::Text, text);
  p.setColor(QPalette::Button, dark ? QColor(0x35, 0x38, 0x3c) : QColor(0xe8, 0xea, 0xec));
  p.setColor(QPalette::ButtonText, text);
  p.setColor(QPalette::BrightText, Qt::white);
  p.setColor(QPalette::ToolTipBase, dark ? QColor(0x3a, 0x3d, 0x41) : QColor(0xff, 0xff, 0xf2));
  p.setColor(QPalette::ToolTipText, text);
  p.setColor(QPalette::PlaceholderText, faded);
  p.setColor(QPalette::Highlight, accentColour());
  p.setColor(QPalette::HighlightedText, Qt::white);
  p.setColor(QPalette::Link, dark ? QColor(0x6f, 0xb1, 0xf0) : QColor(0x1a, 0x62, 0xa8));
  p.setColor(QPalette::Light, dark ? QColor(0x3e, 0x42, 0x46) : QColor(0xff, 0xff, 0xff));
  p.setColor(QPalette::Midlight, dark ? QColor(0x36, 0x39, 0x3d) : QColor(0xf0, 0xf1, 0xf2));
  p.setColor(QPalette::Mid, dark ? QColor(0x46, 0x4a, 0x4f) : QColor(0xc4, 0xc8, 0xcc));
  p.setColor(QPalette::Dark, dark ? QColor(0x18, 0x1a, 0x1c) : QColor(0xa8, 0xac, 0xb0));
  p.setColor(QPalette::Shadow, dark ? QColor(0x10, 0x11, 0x12) : QColor(0x80, 0x84, 0x88));
  for (const auto role : {QPalette::WindowText, QPalette::Text, QPalette::ButtonText})
    p.setColor(QPalette::Disabled, role, disabled);
  p.setColor(QPalette::Disabled, QPalette::Highlight, p.color(QPalette::Mid));  // a disabled slider's groove, too
  return p;
}

QString styleSheet(Theme theme) {
  const QPalette p = palette(theme);
  const QString line = (theme == Theme::Dark ? QColor(0x3a, 0x3d, 0x41) : QColor(0xd4, 0xd8, 0xdb)).name();
  const QString faded = (theme == Theme::Dark ? QColor(0xa2, 0xa7, 0xac) : QColor(0x5c, 0x62, 0x68)).name();
  return QStringLiteral(
             "QToolTip { color: %5; background: %6; border: 1px solid %1; padding: 3px; }"
             "QMainWindow::separator { background: %1; width: 3px; height: 3px; }"
             "QDockWidget { font-weight: 600; }"
             "QDockWidget::title { background: %2; padding: 4px 8px; border-bottom: 1px solid %1; }"
             // Tabs of docks that do not all fit are scrolled to, not shortened until none can be read.
             "QMainWindow > QTabBar { qproperty-elideMode: ElideNone; }"
             "QToolBar { border: 0; spacing: 2px; padding: 1px 4px; }"
             "QToolBar#tools { border-bottom: 1px solid %1; padding: 2px 4px; }"
             "QStatusBar { border-top: 1px solid %1; } QStatusBar::item { border: 0; }"
             "QTableView { gridline-color: %1; border: 0; }"
             "QHeaderView::section { background: %2; border: 0; border-right: 1px solid %1; border-bottom: 1px solid %1; "
             "padding: 3px 6px; }"
             "QScrollArea { border: 0; } QListWidget, QUndoView, QPlainTextEdit { border: 0; }"
             "QLabel[role=\"group\"] { color: %3; font-weight: 600; padding-top: 6px; }"
             "QLabel[role=\"faded\"] { color: %3; }"
             "QToolButton[role=\"warning\"] { color: %4; }")
      .arg(line, p.color(QPalette::Window).name(), faded, warningColour().name(), p.color(QPalette::ToolTipText).name(),
           p.color(QPalette::ToolTipBase).name());
}
}  // namespace

void applyTheme(QApplication& app, Theme theme) {
  initIcons();
  theTheme = theme;
  app.setStyle(new ClearStyle);
  app.setPalette(palette(theme));
  app.setStyleSheet(styleSheet(theme));
}

Theme currentTheme() { return theTheme; }
Theme keptTheme() {
  return QSettings().value(QLatin1String(kThemeKey)).toString() == QLatin1String(kLight) ? Theme::Light : Theme::Dark;
}
void keepTheme(Theme theme) {
  QSettings().setValue(QLatin1String(kThemeKey), QLatin1String(theme == Theme::Light ? kLight : kDark));
}
QIcon icon(const QString& name) { return QIcon(new SvgIconEngine(name)); }
/// White text is on it, where a row or a box is selected.
QColor accentColour() { return toQColor(draw::readableOn({1, 1, 1}, draw::kActiveView)); }
QColor focusColour() { return theTheme == Theme::Dark ? QColor(0x8c, 0xc4, 0xff) : QColor(0x0b, 0x57, 0xa4); }
QColor warningColour() { return theTheme == Theme::Dark ? QColor(0xe0, 0xa8, 0x30) : QColor(0x8f, 0x5e, 0x00); }
QColor errorColour() { return theTheme == Theme::Dark ? QColor(0xf0, 0x7a, 0x6a) : QColor(0xb3, 0x2a, 0x1a); }
QColor toQColor(const draw::Colour& c) { return QColor::fromRgbF(c[0], c[1], c[2]); }

QIcon colourSwatch(const QColor& colour) {
  QIcon swatch;
  for (const int ratio : {1, 2}) {
    QPixmap picture(12 * ratio, 12 * ratio);
    picture.setDevicePixelRatio(ratio);
    picture.fill(colour);
    if (colour.lightnessF() > 0.9) {  // white would not be seen on white
      QPainter painter(&picture);
      painter.setPen(QColor(0x80, 0x84, 0x88));
      painter.drawRect(QRectF(0.5, 0.5, 11, 11));
    }
    for (const QIcon::Mode mode : {QIcon::Normal, QIcon::Selected}) swatch.addPixmap(picture, mode);  // never tinted
  }
  return swatch;
}

}  // namespace glint::gui
