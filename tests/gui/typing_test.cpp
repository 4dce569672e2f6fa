// SPDX-License-Identifier: BSD-3-Clause
// What is typed into boxes, and the wheel over them: with real keys and wheel events.
#include <QComboBox>
#include <QDoubleSpinBox>
#include <QLabel>
#include <QLineEdit>
#include <QLocale>
#include <QScrollArea>
#include <QScrollBar>
#include <QSlider>
#include <QTreeWidget>
#include <QVBoxLayout>
#include <QWheelEvent>

#include "gui/base/number_box.h"
#include "gui/base/text.h"
#include "gui/panels/parameter_panel.h"
#include "gui/panels/setup_panel.h"
#include "gui/window/palette.h"
#include "tests/gui/window_fixture.h"

namespace glint::gui {

namespace {
/// The message in the window of a widget about the typed text; "" = no message.
QString complaint(const QWidget* widget) {
  const auto* label = widget->window()->findChild<QLabel*>(QStringLiteral("complaint"));
  return label && label->isVisible() ? label->text() : QString();
}

void type(QAbstractSpinBox* box, const char* text) {
  box->setFocus();
  box->selectAll();
  QTest::keyClicks(box, text);
  QTest::keyClick(box, Qt::Key_Return);
}

void turnWheel(QWidget* widget, int angle) {
  const QPointF at = widget->rect().center();
  QWheelEvent wheel(at, widget->mapToGlobal(at.toPoint()), {}, QPoint(0, angle), Qt::NoButton, Qt::NoModifier, Qt::NoScrollPhase,
                    false);
  QSpontaneKeyEvent::setSpontaneous(
      &wheel);                   // as from the window system: only then what a widget does not take goes on to its parent
  qApp->notify(widget, &wheel);  // sendEvent would take the mark away
}
}  // namespace

class TypingTest : public QObject, WindowFixture {
  Q_OBJECT
 private slots:
  void numbersAsPeopleWriteThem() {
    struct Row {
      const char* typed;
      double expected;
    };
    for (const Row& row : std::initializer_list<Row>{{"0.5", 0.5},
                                                     {"0,5", 0.5},
                                                     {" 12,25 ", 12.25},
                                                     {"-3,5", -3.5},
                                                     {"1,5e-3", 0.0015},
                                                     {"1e-10", 1e-10},
                                                     {"0,500", 0.5},
                                                     {"7", 7},
                                                     {",5", 0.5},
                                                     {"1234,5", 1234.5}})
      QCOMPARE(numberFromText(row.typed).value_or(-1), row.expected);
    QString why;
    for (const char* typed : {"", "abc", "1,234", "1,234,567", "1.234,5", "1 2", "nan", "inf", "0x10", "1,,5"})
      QVERIFY2(!numberFromText(typed, &why), typed);
    QVERIFY(!numberFromText("1,234", &why));
    QVERIFY2(why.contains("1.234") && why.contains("1234"), qPrintable(why));
    QVERIFY(!numberFromText("abc", &why));
    QCOMPARE(why, QStringLiteral("\"abc\" is not a number"));
  }

  void aBoxSaysWhatIsWrongAndTakesADecimalComma() {
    const QLocale before;
    for (const QLocale& locale : {QLocale(QLocale::C), QLocale(QLocale::German, QLocale::Germany)}) {
      QLocale::setDefault(locale);
      Document document(parseTrainSpec);
      ParameterPanel panel(document);
      document.open(fixture_.opened());
      panel.resize(380, 700);
      panel.show();
      QVERIFY(QTest::qWaitForWindowExposed(&panel));
      panel.activateWindow();
      auto* box = panel.findChild<QDoubleSpinBox*>("value:detect.level");
      type(box, "0,37");
      QCOMPARE(document.request().settings.number("detect.level"), 0.37);
      QVERIFY2(box->text().startsWith("0.37"), qPrintable(box->text()));
      QCOMPARE(complaint(box), QString());
      // A double click marks the whole number, not the digits on one side of its point.
      auto* const line = box->findChild<QLineEdit*>();
      QTest::mouseDClick(line, Qt::LeftButton, {}, QPoint(line->width() / 4, line->height() / 2));
      QCOMPARE(line->selectedText(), box->text());
      type(box, "half");
      QCOMPARE(document.request().settings.number("detect.level"), 0.37);
      QVERIFY2(complaint(box).contains("\"half\" is not a number") && complaint(box).contains("keeping 0.37"),
               qPrintable(complaint(box)));
      type(box, "7");
      QCOMPARE(document.request().settings.number("detect.level"), 0.37);
      QVERIFY2(complaint(box).contains("7 is outside"), qPrintable(complaint(box)));
      QTest::keyClicks(box, "0");  // typing again: it has been read
      QCOMPARE(complaint(box), QString());
      auto* whole = panel.findChild<QDoubleSpinBox*>("value:predict.directions");
      type(whole, "12.5");
      QVERIFY2(complaint(whole).contains("12.5 is not a whole number"), qPrintable(complaint(whole)));
      const auto* label = panel.findChild<QLabel*>(QStringLiteral("complaint"));
      const QRect said = label->geometry();
      QVERIFY2(panel.rect().contains(said),
               qPrintable(QStringLiteral("%1 %2 %3 %4").arg(said.x()).arg(said.y()).arg(said.width()).arg(said.height())));
    }
    QLocale::setDefault(before);
  }

  void aTrainingSpecificationSaysWhatIsWrong() {
    Document document(parseTrainSpec);
    SetupPanel panel(document);
    document.open(fixture_.opened());
    panel.resize(300, 420);
    panel.show();
    QVERIFY(QTest::qWaitForWindowExposed(&panel));
    auto* train = panel.findChild<QComboBox*>("train");
    train->setFocus();
    train->lineEdit()->selectAll();
    QTest::keyClicks(train->lineEdit(), "first:many");
    QTest::keyClick(train->lineEdit(), Qt::Key_Return);
    QCOMPARE(document.request().train, std::string("first:6"));
    QVERIFY2(complaint(train).contains("first:many: ") && complaint(train).contains("keeping first:6") &&
                 !complaint(train).contains("--"),
             qPrintable(complaint(train)));
    QCOMPARE(document.request().train, std::string("first:6"));
    QCOMPARE(train->currentText(), QStringLiteral("first:6"));
    auto* enough = panel.findChild<QDoubleSpinBox*>("goodEnough");
    QCOMPARE(enough->text(), QStringLiteral("best accuracy"));
    type(enough, "0,5");
    QCOMPARE(enough->value(), 0.5);
    type(enough, "little");
    QCOMPARE(enough->value(), 0.5);
    QVERIFY2(complaint(enough).contains("\"little\" is not a number"), qPrintable(complaint(enough)));
  }

  void thePaletteTakesADecimalCommaAndSaysWhatIsWrong() {
    MainWindow window(fixture_.engine());
    openActive(window);
    Palette* palette = window.commandPalette();
    auto* line = palette->findChild<QLineEdit*>();
    const auto enter = [&](const char* text) {
      palette->popUp();
      QTest::keyClicks(line, text);
      QTest::keyClick(line, Qt::Key_Return);
    };
    enter("contour level = 0,37");
    QCOMPARE(window.document().request().settings.number("detect.level"), 0.37);
    QVERIFY(!palette->isVisible());
    enter("contour level = half");
    QCOMPARE(window.document().request().settings.number("detect.level"), 0.37);
    QVERIFY2(palette->isVisible() && complaint(line).contains("is not a number"), qPrintable(complaint(line)));
    palette->hide();
    enter("qqqqqqqq");
    QVERIFY2(complaint(line).contains("qqqqqqqq"), qPrintable(complaint(line)));
    palette->hide();
  }

  /// The wheel scrolls the panel, until a box was clicked.
  void theWheelScrollsUntilABoxHasTheFocus() {
    MainWindow window(fixture_.engine());
    openActive(window);
    Document& d = window.document();
    const InspectionRequest before = d.request();
    const std::map<std::string, std::string> options = d.state().options;
    window.centralWidget()->setFocus();
    int boxes = 0;
    for (QWidget* widget : window.findChildren<QWidget*>()) {
      const bool holds =
          qobject_cast<QAbstractSpinBox*>(widget) || qobject_cast<QComboBox*>(widget) || qobject_cast<QSlider*>(widget);
      if (!holds || !widget->isVisible() || widget->hasFocus()) continue;
      ++boxes;
      QVERIFY2(widget->focusPolicy() != Qt::WheelFocus, qPrintable(widget->objectName()));
      turnWheel(widget, -120);
      QVERIFY2(!widget->hasFocus(), qPrintable(widget->objectName()));
    }
    QVERIFY(boxes > 10);
    QVERIFY(d.request() == before);
    QVERIFY(d.state().options == options);
    // A panel of its own, so low that there is something to scroll.
    ParameterPanel low(d);
    low.resize(380, 240);
    low.show();
    QVERIFY(QTest::qWaitForWindowExposed(&low));
    QTRY_VERIFY(low.verticalScrollBar()->maximum() > 0);
    // The window that appears gives the focus to its first box.
    for (QSlider* slider : low.findChildren<QSlider*>())
      if (!slider->hasFocus()) {
        turnWheel(slider, -240);
        break;
      }
    QVERIFY(low.verticalScrollBar()->value() > 0);
    QVERIFY(d.request() == before);
    window.activateWindow();
    auto* source = window.findChild<QComboBox*>("source");
    source->setFocus();
    turnWheel(source, -120);
    QCOMPARE(source->currentIndex(), 1);
  }
};

QObject* makeTypingTest() { return new TypingTest; }

}  // namespace glint::gui

#include "typing_test.moc"
