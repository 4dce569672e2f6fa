// SPDX-License-Identifier: BSD-3-Clause
#include "gui/base/theme.h"

#include <QAction>
#include <QApplication>
#include <QCheckBox>
#include <QComboBox>
#include <QHelpEvent>
#include <QImage>
#include <QLabel>
#include <QLineEdit>
#include <QListWidget>
#include <QPainter>
#include <QPushButton>
#include <QRadioButton>
#include <QScrollBar>
#include <QSpinBox>
#include <QTextBrowser>
#include <QToolTip>
#include <QVBoxLayout>
#include <algorithm>
#include <cmath>
#include <memory>

#include "core/draw/plot_painter.h"
#include "core/draw/plots.h"
#include "gui/base/elided_label.h"
#include "gui/base/panel_scroll.h"
#include "gui/base/stale_badge.h"
#include "gui/base/text.h"
#include "gui/frame/ladder_panel.h"
#include "gui/plots/conditioning_panel.h"
#include "gui/window/main_window.h"
#include "tests/gui/window_fixture.h"

namespace glint::gui {

namespace {
/// Relative luminance and contrast of Web Content Accessibility Guidelines 2.1; 1.4.11 asks for 3 : 1.
double luminance(const QColor& c) {
  const auto linear = [](double v) { return v <= 0.03928 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4); };
  return 0.2126 * linear(c.redF()) + 0.7152 * linear(c.greenF()) + 0.0722 * linear(c.blueF());
}
double contrast(const QColor& a, const QColor& b) {
  const double la = luminance(a), lb = luminance(b);
  return (std::max(la, lb) + 0.05) / (std::min(la, lb) + 0.05);
}
constexpr double kEnough = 3;

/// How many of the pixels in `area` stand out from the background.
int clearPixels(const QImage& image, const QRect& area, const QColor& background) {
  int n = 0;
  for (int y = area.top(); y <= area.bottom(); ++y)
    for (int x = area.left(); x <= area.right(); ++x)
      if (image.rect().contains(x, y) && contrast(image.pixelColor(x, y), background) >= kEnough) ++n;
  return n;
}

/// A widget without the ratio of the screen, so that its pixels are those of its coordinates.
QImage drawn(QWidget& widget) {
  QImage image(widget.size(), QImage::Format_RGB32);
  image.fill(widget.palette().color(QPalette::Window));
  widget.render(&image);
  return image;
}
}  // namespace

class ThemeTest : public QObject, WindowFixture {
  Q_OBJECT
 private slots:
  /// Texts that hold colours of the theme follow it; else they would be light on light until the next result.
  void aChangeOfThemeReachesTextsWithColours() {
    MainWindow window(fixture_.engine());
    show(window);
    openAndWait(window);
    window.document().selectFrame(window.document().frameCount() - 1);  // whose predictions fail
    window.actions().find("explain.start")->trigger();
    window.applyLayout(QStringLiteral("compare"));
    auto* text = window.findChild<QTextBrowser*>(QStringLiteral("explain.text"));
    const auto* ladder = window.findChild<LadderPanel*>();
    QTRY_VERIFY(window.idle() && !ladder->canvases().empty());
    for (const Theme theme : {Theme::Light, Theme::Dark}) {
      window.setTheme(theme);
      const QString faded = window.palette().color(QPalette::PlaceholderText).name();
      for (const char* name : {"frameCaptions", "errorSummary"})
        QTRY_VERIFY2(window.findChild<QLabel*>(QLatin1String(name))->text().contains(faded), name);
      QTRY_VERIFY(text->toHtml().contains(faded));
      const auto warned = [&] {
        for (const QLabel* label : ladder->findChildren<QLabel*>())
          if (label->text().contains(warningColour().name())) return true;
        return false;
      };
      QTRY_VERIFY(warned());
    }
  }

  void theThemeThatWasChosenIsThatOfTheNextStart() {
    MainWindow window(fixture_.engine());
    for (const Theme chosen : {keptTheme() == Theme::Dark ? Theme::Light : Theme::Dark, keptTheme()}) {
      window.setTheme(chosen == Theme::Dark ? Theme::Light : Theme::Dark);
      window.actions().find("view.theme")->trigger();
      QCOMPARE(currentTheme(), chosen);
      QCOMPARE(keptTheme(), chosen);
      window.setTheme(chosen == Theme::Dark ? Theme::Light : Theme::Dark);  // as --theme of one start does
      QCOMPARE(keptTheme(), chosen);
    }
    window.setTheme(Theme::Dark);
    keepTheme(Theme::Dark);
  }

  void cleanup() { applyTheme(*qApp, Theme::Dark); }

  /// "updating…" says that the widget below it is old; the bars of a table would hide half of the words.
  void aBadgeKeepsClearOfScrollBars() {
    QListWidget list;
    list.setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOn);
    list.setVerticalScrollBarPolicy(Qt::ScrollBarAlwaysOn);
    StaleBadge badge(&list, Qt::BottomRightCorner);
    list.resize(300, 200);
    list.show();
    QVERIFY(QTest::qWaitForWindowExposed(&list));
    badge.setStale(true);
    QTRY_VERIFY(badge.isVisible());
    QVERIFY(list.viewport()->geometry().contains(badge.geometry()));
    list.resize(240, 120);
    QTRY_VERIFY(list.viewport()->geometry().contains(badge.geometry()));
    QVERIFY(badge.geometry().bottom() > list.viewport()->height() / 2);
  }

  void aSwatchKeepsItsColourInASelectedRow() {
    const QIcon swatch = colourSwatch(QColor(0xe6, 0x9f, 0x00));
    for (const QIcon::Mode mode : {QIcon::Normal, QIcon::Selected})
      QCOMPARE(swatch.pixmap(12, 12, mode).toImage().pixelColor(6, 6), QColor(0xe6, 0x9f, 0x00));
    // White is told from white by its edge.
    QVERIFY(colourSwatch(Qt::white).pixmap(12, 12).toImage().pixelColor(0, 5) != QColor(Qt::white));
  }

  void anUntickedBoxStandsOut_data() { themes(); }
  void anUntickedBoxStandsOut() {
    QFETCH(int, theme);
    applyTheme(*qApp, Theme(theme));
    QCheckBox check;
    QRadioButton radio;
    for (QAbstractButton* button : {static_cast<QAbstractButton*>(&check), static_cast<QAbstractButton*>(&radio)}) {
      button->resize(button->sizeHint());
      const QImage image = drawn(*button);
      // A line all the way round a square of 13 px is 48 px; a circle's is shorter, and partly between pixels.
      QVERIFY(clearPixels(image, image.rect(), button->palette().color(QPalette::Window)) >= 20);
    }
    QListWidget list;
    list.setFrameShape(QFrame::NoFrame);
    auto* item = new QListWidgetItem(&list);
    item->setCheckState(Qt::Unchecked);
    list.resize(80, 40);
    const QImage image = drawn(list);
    QVERIFY(clearPixels(image, list.visualItemRect(item), list.palette().color(QPalette::Base)) >= 40);
    item->setCheckState(Qt::Checked);
    const QImage ticked = drawn(list);
    QVERIFY(ticked != image);
    // What is on is filled with the accent colour, and has a white mark in it.
    check.setChecked(true);
    radio.setChecked(true);
    for (QAbstractButton* button : {static_cast<QAbstractButton*>(&check), static_cast<QAbstractButton*>(&radio)}) {
      const QImage on = drawn(*button);
      int filled = 0, mark = 0;
      for (int y = 0; y < on.height(); ++y)
        for (int x = 0; x < on.width(); ++x) {
          filled += on.pixelColor(x, y).rgb() == accentColour().rgb();
          mark += contrast(on.pixelColor(x, y), accentColour()) >= kEnough && on.pixelColor(x, y).lightness() > 200;
        }
      // In a light window the ground around it is light, too: the mark is what is inside.
      const QColor centre = on.pixelColor(on.height() / 2, on.height() / 2);
      QVERIFY2(filled >= 40, qPrintable(QString::number(filled)));
      QVERIFY2(mark >= 8, qPrintable(QString::number(mark)));
      if (button == &radio) QCOMPARE(centre, QColor(Qt::white));
    }
    int white = 0;
    const QImage tick = drawn(check);
    for (int y = 3; y < tick.height() - 3; ++y)
      for (int x = 3; x < tick.height() - 3; ++x) white += tick.pixelColor(x, y).lightness() > 240;
    QVERIFY2(white >= 4, qPrintable(QString::number(white)));
  }

  /// 1.4.3 of the same guidelines asks for 4.5 : 1 where text is read.
  void fadedTextIsReadable_data() { themes(); }
  void fadedTextIsReadable() {
    QFETCH(int, theme);
    applyTheme(*qApp, Theme(theme));
    const QPalette palette = qApp->palette();
    for (const auto ground : {QPalette::Window, QPalette::Base})
      QVERIFY(contrast(palette.color(QPalette::PlaceholderText), palette.color(ground)) >= 4.5);
  }

  void everyTextIsReadable_data() { themes(); }
  void everyTextIsReadable() {
    QFETCH(int, theme);
    applyTheme(*qApp, Theme(theme));
    const QPalette p = qApp->palette();
    struct Pair {
      const char* name;
      QColor text;
      QList<QPalette::ColorRole> grounds;
    };
    const QList<QPalette::ColorRole> pages{QPalette::Window, QPalette::Base, QPalette::AlternateBase};
    QLabel faded;
    faded.setProperty("role", "faded");
    faded.ensurePolished();
    for (const Pair& pair :
         std::vector<Pair>{{"text", p.color(QPalette::Text), pages},
                           {"window text", p.color(QPalette::WindowText), pages},
                           {"button text", p.color(QPalette::ButtonText), {QPalette::Button, QPalette::Window}},
                           {"link", p.color(QPalette::Link), pages},
                           {"placeholder", p.color(QPalette::PlaceholderText), pages},
                           {"faded", faded.palette().color(QPalette::WindowText), pages},
                           {"warning", warningColour(), pages},
                           {"error", errorColour(), pages},
                           {"selected", p.color(QPalette::HighlightedText), {QPalette::Highlight}},
                           {"tool tip", p.color(QPalette::ToolTipText), {QPalette::ToolTipBase}}})
      for (const QPalette::ColorRole ground : pair.grounds) {
        const double found = contrast(pair.text, p.color(ground));
        QVERIFY2(found >= 4.5, qPrintable(QStringLiteral("%1 on role %2: %3").arg(pair.name).arg(int(ground)).arg(found)));
      }
  }

  /// Every text of a plot, on the ground that it is painted on: on screen, on a page, in a file.
  void everyTextOfAPlotIsReadable_data() { themes(); }
  void everyTextOfAPlotIsReadable() {
    QFETCH(int, theme);
    struct Texts : draw::Painter {
      std::optional<draw::Colour> ground;
      std::vector<std::pair<std::string, draw::Colour>> texts;
      void fill(const draw::Box& box, const draw::Colour& colour, double opacity) override {
        if (!ground && box.x == 0 && box.y == 0 && opacity == 1) ground = colour;
      }
      void stroke(const std::vector<Eigen::Vector2d>&, bool, const draw::Colour&, double, draw::Dash, const draw::Box&) override {
      }
      void disc(const Eigen::Vector2d&, double, const draw::Colour&) override {}
      void text(const Eigen::Vector2d&, const std::string& text, double, const draw::Colour& colour, draw::Align, bool,
                bool) override {
        texts.emplace_back(text, colour);
      }
      double textWidth(const std::string& text, double size, bool) const override { return 0.6 * size * double(text.size()); }
    };
    const Fixture fixture;
    InspectionRequest request = fixture.opened().request;
    const Inspection inspection = drawnCircles(fixture.scene(), request);
    draw::PlotData nothing;
    nothing.title = "Nothing";
    nothing.empty = "No results yet";
    for (const draw::PlotData& plot : {draw::errorPlot(inspection), draw::residualDial(inspection, 0, -1), nothing}) {
      Texts painter;
      draw::paintPlot(painter, plot, {Theme(theme) == Theme::Dark, 1}, draw::rangeOf(plot), {}, 640, 400);
      QVERIFY(painter.ground && !painter.texts.empty());
      for (const auto& [text, colour] : painter.texts) {
        const double found = contrast(toQColor(colour), toQColor(*painter.ground));
        QVERIFY2(found >= 4.5, qPrintable(QStringLiteral("%1: %2").arg(toQString(text)).arg(found)));
      }
    }
  }

  /// A verdict is white on its colour.
  void everyVerdictIsReadable() {
    for (const Verdict verdict : {Verdict::Green, Verdict::Amber, Verdict::Red, Verdict::Unknown}) {
      Chip chip(verdict, QString());
      chip.resize(60, 20);
      const double found = contrast(Qt::white, drawn(chip).pixelColor(6, 4));
      QVERIFY2(found >= 4.5, qPrintable(QStringLiteral("%1: %2").arg(int(verdict)).arg(found)));
    }
  }

  void theFocusOfTheKeyboardStandsOut_data() { themes(); }
  void theFocusOfTheKeyboardStandsOut() {
    QFETCH(int, theme);
    applyTheme(*qApp, Theme(theme));
    QWidget window;
    QPushButton button(QStringLiteral("Auto"), &window);
    QLineEdit line(&window);
    QComboBox combo(&window);
    QSpinBox spin(&window);
    int y = 4;
    const QList<QWidget*> all{&button, &line, &combo, &spin};
    for (QWidget* w : all) {
      w->setGeometry(4, y, 100, 28);
      y += 32;
    }
    window.resize(120, y + 4);
    window.show();
    QVERIFY(QTest::qWaitForWindowExposed(&window));
    QApplication::setActiveWindow(&window);  // there is no window manager
    const QColor background = window.palette().color(QPalette::Window);
    window.setFocus();
    window.setAttribute(Qt::WA_KeyboardFocusChange);  // as the Tab key does
    const QImage before = drawn(window);
    for (QWidget* w : all) {
      w->setFocus(Qt::TabFocusReason);
      QTRY_VERIFY(w->hasFocus());
      const QImage after = drawn(window);
      int changed = 0;
      for (int py = w->y(); py < w->geometry().bottom(); ++py)
        for (int px = w->x(); px < w->geometry().right(); ++px)
          changed += after.pixel(px, py) != before.pixel(px, py) && contrast(after.pixelColor(px, py), background) >= kEnough;
      // A ring of 2 px around 100 x 28 is 500 px, less what its round corners and smoothed edge lose: 366 to 521 are counted.
      // Fusion's own thin frame and the selected number are 0 to 316.
      QVERIFY2(changed >= 340, qPrintable(QStringLiteral("%1: %2").arg(w->metaObject()->className()).arg(changed)));
    }
  }

  void aLabelThatIsCutSaysSo() {
    const QString text = QStringLiteral("Smallest highlight, in pixels of the photograph");
    ElidedLabel label(text);
    label.resize(label.sizeHint());
    QVERIFY(!label.isCut());
    const int least = label.minimumSizeHint().width();
    QVERIFY(least < label.sizeHint().width() / 3);
    label.resize(least, label.height());
    QVERIFY(label.isCut());
    QCOMPARE(label.text(), text);
    // It ends in dots before its edge; the text itself would run on to it.
    label.resize(100, label.height());
    QLabel dots(label.fontMetrics().elidedText(text, Qt::ElideRight, label.contentsRect().width()));
    dots.resize(label.size());
    QVERIFY(dots.text().endsWith(QChar(0x2026)));
    QCOMPARE(drawn(label), drawn(dots));
    label.show();
    QVERIFY(QTest::qWaitForWindowExposed(&label));
    const auto toolTip = [&] {
      QToolTip::hideText();
      QTRY_VERIFY(!QToolTip::isVisible());
      QHelpEvent help(QEvent::ToolTip, label.rect().center(), label.mapToGlobal(label.rect().center()));
      QCoreApplication::sendEvent(&label, &help);
    };
    toolTip();
    QTRY_COMPARE(QToolTip::text(), text);
    label.resize(label.sizeHint());
    toolTip();
    QVERIFY(!QToolTip::isVisible());
  }

  /// The part of a panel that has no room is behind a scroll bar, not cut.
  void aPanelScrollsWhatItHasNoRoomFor() {
    auto* content = new QWidget;
    content->setMinimumSize(300, 200);
    PanelScroll scroll(content, {100, 60});
    QCOMPARE(scroll.minimumSizeHint(), QSize(100, 60));
    scroll.resize(400, 250);
    scroll.show();
    QVERIFY(QTest::qWaitForWindowExposed(&scroll));
    QCOMPARE(content->size(), scroll.viewport()->size());
    QVERIFY(!scroll.verticalScrollBar()->isVisible() && !scroll.horizontalScrollBar()->isVisible());
    scroll.resize(400, 100);
    QTRY_VERIFY(scroll.verticalScrollBar()->isVisible());
    QCOMPARE(content->height(), 200);
    QVERIFY(!scroll.horizontalScrollBar()->isVisible());
    scroll.resize(120, 100);
    QTRY_VERIFY(scroll.horizontalScrollBar()->isVisible());
    QCOMPARE(content->size(), QSize(300, 200));
    scroll.resize(120, 250);  // high enough, but for the bar below
    QTRY_VERIFY(!scroll.verticalScrollBar()->isVisible());
    QVERIFY(scroll.horizontalScrollBar()->isVisible());
    QCOMPARE(content->size(), QSize(300, scroll.viewport()->height()));
  }

  void whatHugsTakesNoMoreThanItsContent() {
    auto* text = new QLabel(QStringLiteral("one two three four five six seven eight nine ten eleven twelve thirteen fourteen"));
    text->setWordWrap(true);
    auto* rest = new QWidget;
    rest->setMinimumHeight(40);
    QWidget window;
    auto* column = new QVBoxLayout(&window);
    column->setContentsMargins(0, 0, 0, 0);
    column->setSpacing(0);
    auto* scroll = new PanelScroll(text, {50, 20}, PanelScroll::Height::Hugs);
    column->addWidget(scroll);
    column->addWidget(rest, 1);
    window.resize(120, 300);
    window.show();
    QVERIFY(QTest::qWaitForWindowExposed(&window));
    QTRY_COMPARE(scroll->height(), text->heightForWidth(120));
    window.resize(240, 300);
    QTRY_COMPARE(scroll->height(), text->heightForWidth(240));
    window.resize(120, 70);
    QTRY_VERIFY(scroll->verticalScrollBar()->isVisible());
    QVERIFY(rest->height() >= 40);
    window.resize(120, 300);
    scroll->setMost(30);
    QTRY_COMPARE(scroll->height(), 30);
    QTRY_VERIFY(scroll->verticalScrollBar()->isVisible());
    scroll->setMost(1000);
    QTRY_COMPARE(scroll->height(), text->heightForWidth(120));
    window.resize(240, 300);
    text->hide();
    QTRY_COMPARE(scroll->height(), 0);
  }

 private:
  static void themes() {
    QTest::addColumn<int>("theme");
    QTest::newRow("dark") << int(Theme::Dark);
    QTest::newRow("light") << int(Theme::Light);
  }
};

QObject* makeThemeTest() { return new ThemeTest; }

}  // namespace glint::gui

#include "theme_test.moc"
