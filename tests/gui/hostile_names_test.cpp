// SPDX-License-Identifier: BSD-3-Clause
// Names from files that look like markup, or hold line ends, escapes and marks that turn the direction of writing: every widget
// of the window shows them as they are, or escaped.
#include <QAbstractItemView>
#include <QAction>
#include <QDir>
#include <QDirIterator>
#include <QFile>
#include <QFileInfo>
#include <QGroupBox>
#include <QJsonArray>
#include <QJsonDocument>
#include <QJsonObject>
#include <QLabel>
#include <QMenu>
#include <QMessageBox>
#include <QPlainTextEdit>
#include <QRegularExpression>
#include <QStatusBar>
#include <QTabBar>
#include <QTemporaryDir>
#include <QTextBrowser>
#include <QTextDocument>
#include <QToolTip>

#include "core/report/report.h"
#include "gui/base/text.h"
#include "gui/base/tips.h"
#include "gui/timeline/timeline.h"
#include "gui/window/main_window.h"
#include "gui/window/message_bar.h"
#include "tests/gui/fixture.h"
#include "tests/gui/folders.h"

namespace glint::gui {

namespace {
const QString kMarkup = QStringLiteral("<b>x</b><img src='file:///nowhere.png'>&amp");
/// A line end, a terminal's escape, a mark that writes the rest from right to left, and an end of line of another kind.
const QString kControls = QStringLiteral("a\nb\x1b[31m") + QChar(0x202E) + QStringLiteral("gpj.exe") + QChar(0x2028);
/// The part of it that the reader accepts in the names of a scene: ids with control characters are refused.
const QString kTurned = QChar(0x202E) + QStringLiteral("gpj.exe") + QChar(0x2028);

bool isControl(QChar c) {
  const ushort u = c.unicode();
  return (u < 0x20 && u != '\n' && u != '\t') || (u >= 0x7F && u < 0xA0) || (u >= 0x202A && u <= 0x202E) ||
         (u >= 0x2066 && u <= 0x2069) || u == 0x2028 || u == 0x200F;
}
}  // namespace

class HostileNamesTest : public QObject {
  Q_OBJECT
 private slots:
  void everyWidgetShowsThemAsText() {
    const QString folder = folder_.filePath(QStringLiteral("<i>tilted</i>&amp <img src='file:///nowhere.png'>"));
    writeScene(folder);
    const QString scene = folder + "/scene.json";
    MainWindow window(coreEngine());
    window.show();
    window.open(scene);
    QTRY_VERIFY_WITH_TIMEOUT(window.document().scene() && window.idle() && window.document().inspection(), 60000);
    Document& d = window.document();
    QVERIFY(d.setTrain("0-3"));
    d.select({0, "canonical", 0});
    QTRY_VERIFY_WITH_TIMEOUT(window.idle() && !d.stale(), 60000);
    window.actions().find("explain.start")->trigger();
    QTRY_VERIFY(window.idle());
    d.selectFrame(1);
    d.selectFrame(0);
    checkAll(window, "opened");
    QVERIFY2(seen_.contains(kMarkup.toHtmlEscaped()) || seen_.contains(kMarkup), "the names are on screen");

    // Error messages name files. (Another window: this one would ask whether to save first.)
    MainWindow failing(coreEngine());
    failing.show();
    auto* bar = failing.findChild<MessageBar*>(QStringLiteral("messageBar"));
    failing.open(folder + "/none" + kControls + ".json");
    QTRY_VERIFY_WITH_TIMEOUT(bar->isVisible() && failing.idle(), 20000);
    QVERIFY2(bar->text().contains("<i>tilted</i>&amp <img"), qPrintable(bar->text()));
    QVERIFY2(!bar->text().contains('\n'), qPrintable(bar->text()));
    checkAll(failing, "failed");
    const auto* label = bar->findChild<QLabel*>();
    QCOMPARE(label->textFormat(), Qt::PlainText);
  }

  void theTitleIsTheName() {
    const QString folder = folder_.filePath("plain");
    writeScene(folder);
    const QString odd = folder + "/<b>odd[*].json";
    QVERIFY(QFile::copy(folder + "/scene.json", odd));
    MainWindow window(coreEngine());
    window.show();
    window.open(odd);
    QTRY_VERIFY_WITH_TIMEOUT(window.document().scene() != nullptr, 60000);
    window.document().markSaved(folder + "/<b>odd[*].glint", window.document().state());
    QVERIFY2(window.windowTitle().contains(" (<b>odd[*][*].glint)[*]"),
             qPrintable(window.windowTitle()));  // Qt's way to write "[*]"
  }

  void labelsTipsAndBoxesArePlainUnlessTheProgramSaysOtherwise() {
    QLabel label(kMarkup);
    label.setToolTip(kMarkup);
    label.show();
    QCOMPARE(label.textFormat(), Qt::PlainText);
    QTextDocument shown;
    shown.setHtml(label.toolTip());
    QCOMPARE(shown.toPlainText(), kMarkup);
    setRichTip(&label, QStringLiteral("<b>bold</b>"));
    QCOMPARE(label.toolTip(), QStringLiteral("<b>bold</b>"));
    label.setToolTip(kMarkup);  // rich once, plain again
    QVERIFY(!label.toolTip().contains("<img"));
    QMessageBox box(QMessageBox::Warning, {}, kMarkup);
    box.show();
    for (const QLabel* part : box.findChildren<QLabel*>()) QVERIFY(part->textFormat() != Qt::AutoText);
  }

  void textsForPeople() {
    QCOMPARE(nameText("a\nb\tc"), QStringLiteral("a\\nb\\tc"));
    QCOMPARE(toQString("a\nb"), QStringLiteral("a\nb"));
    QCOMPARE(toQString("\x1b[31m"), QStringLiteral("\\x1B[31m"));
    QCOMPARE(toQString("\xE2\x80\xAEx"), QStringLiteral("\\u202Ex"));
    QCOMPARE(toQString("\xff"), QStringLiteral("\\xFF"));
    QCOMPARE(exactQString("\xE2\x80\xAEx"), QString(QChar(0x202E)) + "x");
    QCOMPARE(menuText("a&b"), QStringLiteral("a&&b"));
    QVERIFY(!Qt::mightBeRichText(plainTip("plain")));
  }

  void theReportShowsThemAsText() {
    const QString folder = folder_.filePath("reported");
    writeScene(folder);
    const Engine engine = coreEngine();
    Opened opened = engine.open((folder + "/scene.json").toStdString(), {});
    opened.request.train = "0-3";
    opened.request.models = {"canonical"};
    Pipeline pipeline(opened.scene);
    const Pipeline::Answer answer = engine.ask(pipeline, {opened.request}, {});
    const Inspection& inspection = *answer;
    ReportContext context;
    context.input = (folder + kMarkup + kControls).toStdString();
    const QString html = exactQString(evaluationHtml(inspection, context));
    QVERIFY(!html.contains("<img src='file"));
    QVERIFY(html.contains("&lt;img src="));
    for (const QChar c : html) QVERIFY2(!isControl(c), qPrintable(QString::number(c.unicode(), 16)));
  }

 private:
  /// A copy of the plane whose frames and lights have such ids.
  static void writeScene(const QString& folder) {
    copyFolder(QStringLiteral(GLINT_SOURCE_DIR "/sessions/plane"), folder);
    QFile file(folder + "/scene.json");
    QVERIFY(file.open(QIODevice::ReadWrite));
    QJsonObject scene = QJsonDocument::fromJson(file.readAll()).object();
    const auto light = [](const QString& id) { return kMarkup + ' ' + id + kTurned; };
    scene["name"] = kMarkup + kTurned;
    QJsonArray lights = scene["lights"].toArray();
    for (QJsonValueRef v : lights) {
      QJsonObject l = v.toObject();
      l["id"] = light(l["id"].toString());
      v = l;
    }
    scene["lights"] = lights;
    QJsonArray frames = scene["frames"].toArray();
    for (QJsonValueRef v : frames) {
      QJsonObject f = v.toObject();
      f["id"] = kMarkup + f["id"].toString() + kTurned;
      // value(): [] would add what is not there.
      QJsonArray on = f.value("lights_on").toArray(), highlights = f.value("highlights").toArray();
      for (QJsonValueRef l : on) l = light(l.toString());
      for (QJsonValueRef h : highlights) {
        QJsonObject o = h.toObject();
        if (o.contains("light")) o["light"] = light(o["light"].toString());
        h = o;
      }
      if (!on.isEmpty()) f["lights_on"] = on;
      if (!highlights.isEmpty()) f["highlights"] = highlights;
      v = f;
    }
    scene["frames"] = frames;
    file.resize(0);
    file.write(QJsonDocument(scene).toJson());
  }

  void checkText(const QString& text, const QString& where) {
    seen_ += text + '\n';
    for (const QChar c : text)
      QVERIFY2(
          !isControl(c),
          qPrintable(QStringLiteral("%1: U+%2 in %3").arg(where).arg(c.unicode(), 4, 16).arg(toQString(text.toStdString()))));
  }
  /// A tool tip is taken for markup when it looks like it.
  void checkTip(const QString& tip, const QString& where) {
    checkText(tip, where);
    QVERIFY2(!Qt::mightBeRichText(tip) || !tip.contains("<img"), qPrintable(where + ": " + tip));
  }
  void checkModel(const QAbstractItemView& view, const QModelIndex& parent = {}) {
    const QAbstractItemModel& model = *view.model();
    const QString where = QString::fromLatin1(view.metaObject()->className()) + ' ' + view.objectName();
    for (int row = 0; row < model.rowCount(parent); ++row)
      for (int column = 0; column < model.columnCount(parent); ++column) {
        const QModelIndex at = model.index(row, column, parent);
        checkText(at.data(Qt::DisplayRole).toString(), where);
        checkTip(at.data(Qt::ToolTipRole).toString(), where);
        if (column == 0) checkModel(view, at);
      }
  }
  void checkAll(MainWindow& window, const QString& when) {
    seen_.clear();
    checkText(window.windowTitle(), when + " title");
    for (QWidget* widget : window.findChildren<QWidget*>()) {
      widget->ensurePolished();
      const QString where = when + ' ' + QString::fromLatin1(widget->metaObject()->className()) + ' ' + widget->objectName();
      checkTip(widget->toolTip(), where);
      checkText(widget->accessibleName(), where);
      if (const auto* label = qobject_cast<const QLabel*>(widget)) {
        QVERIFY2(label->textFormat() != Qt::AutoText, qPrintable(where));
        QVERIFY2(label->textFormat() == Qt::PlainText || !label->text().contains("<img"), qPrintable(where + label->text()));
        checkText(label->text(), where);
      }
      if (const auto* tabs = qobject_cast<const QTabBar*>(widget))
        for (int i = 0; i < tabs->count(); ++i) {
          checkText(tabs->tabText(i), where);
          checkTip(tabs->tabToolTip(i), where);
        }
      if (const auto* browser = qobject_cast<const QTextBrowser*>(widget)) {
        QString html = browser->toHtml();
        html.remove(QRegularExpression(QStringLiteral("<img src=\"equation:[a-z-]+\"[^>]*>")));  // the program's own
        QVERIFY2(!html.contains("<img"), qPrintable(where));
        checkText(browser->toPlainText(), where);
      }
      if (const auto* plain = qobject_cast<const QPlainTextEdit*>(widget)) checkText(plain->toPlainText(), where);
      if (const auto* view = qobject_cast<const QAbstractItemView*>(widget); view && view->model()) checkModel(*view);
      if (auto* menu = qobject_cast<QMenu*>(widget)) emit menu->aboutToShow();  // those that are filled when they open
    }
    for (const QAction* action : window.findChildren<QAction*>()) {
      checkText(action->text(), when + " action");
      if (action->text().contains("<img"))
        QVERIFY2(!action->text().contains(QRegularExpression("[^&]&amp")), qPrintable(action->text()));
    }
    const TimelineStrip* strip = window.findChild<Timeline*>()->strip();
    for (int x = 2; x < strip->width(); x += 40)
      for (int y = 2; y < strip->height(); y += 6) checkText(strip->tipAt({x, y}), when + " timeline");
  }

  QTemporaryDir folder_;
  QString seen_;
};

QObject* makeHostileNamesTest() { return new HostileNamesTest; }

}  // namespace glint::gui

#include "hostile_names_test.moc"
