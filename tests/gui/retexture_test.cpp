// SPDX-License-Identifier: BSD-3-Clause
// Retexturing in the frame view, by real events: what is shown and written is what `glint retexture` writes, byte for byte.
#include <QApplication>
#include <QDialogButtonBox>
#include <QFile>
#include <QFileDialog>
#include <QImage>
#include <QLabel>
#include <QLineEdit>
#include <QProcess>
#include <QPushButton>
#include <QSignalSpy>
#include <QTimer>
#include <QToolButton>

#include "gui/base/text.h"
#include "gui/base/to_qimage.h"
#include "gui/export/export_actions.h"
#include "gui/frame/frame_canvas.h"
#include "gui/frame/frame_panel.h"
#include "gui/frame/retexture_bar.h"
#include "gui/window/main_window.h"
#include "tests/gui/fixture.h"
#include "tests/gui/folders.h"

namespace glint::gui {

namespace {
QByteArray contentOf(const QString& file) {
  QFile f(file);
  return f.open(QIODevice::ReadOnly) ? f.readAll() : QByteArray();
}

QRect squareAt(int i) { return {32 * (i % 4), 32 * (i / 4), 32, 32}; }

void writeChecked(const QString& file, QColor other) {
  QImage texture(128, 128, QImage::Format_RGB888);
  texture.fill(QColor(220, 140, 60));
  for (int i = 0; i < 16; ++i)
    if ((i + i / 4) % 2)
      for (int y = squareAt(i).top(); y <= squareAt(i).bottom(); ++y)
        for (int x = squareAt(i).left(); x <= squareAt(i).right(); ++x) texture.setPixelColor(x, y, other);
  QVERIFY(texture.save(file, "PNG"));
}
}  // namespace

class RetextureTest : public QObject {
  Q_OBJECT
 private slots:
  void initTestCase() {
    copyFolder(QStringLiteral(GLINT_SOURCE_DIR "/sessions/ellipsoid"), folder_.path() + "/in");
    session_ = folder_.path() + "/in/ellipsoid.glint";
    writeChecked(folder_.path() + "/in/texture.png", QColor(40, 170, 200));
  }
  void init() {
    window_ = std::make_unique<MainWindow>(knownEngine(session_));
    window_->show();
    window_->open(session_);
    settle();
  }
  void cleanup() { window_.reset(); }

  void whatIsWrittenIsWhatTheCommandWrites() {
    QTest::mouseClick(tool(), Qt::LeftButton);
    settle();
    QVERIFY(bar().isVisible());
    QVERIFY2(words().contains("Choose a picture"), qPrintable(words()));
    QVERIFY(!canvas().comparing());
    choose(folder_.path() + "/in/texture.png");
    settle();
    QVERIFY(canvas().comparing());
    QCOMPARE(option("frame/retexture-texture"), std::string("texture.png"));  // relative: the session can be moved
    for (const char* const model : {"canonical", "limit-angle"}) {
      draw::Selection s = document().selection();
      s.model = model;
      s.frame = 7;
      document().select(s);
      compareWithCommand({"--texture", folder_.path() + "/in/texture.png"}, model);
    }
    document().setOption("frame/retexture-mapping", "box", "box");
    document().setOption("frame/retexture-repeat", 3.0, "three");
    document().setOption("frame/retexture-shading", "frame", "shading");
    document().setOption("frame/retexture-albedo", 0.4, "albedo");
    compareWithCommand({"--texture", folder_.path() + "/in/texture.png", "--mapping", "box", "--repeat", "3", "--shading",
                        "frame", "--albedo", "0.4"},
                       "limit-angle");
    document().setOption("frame/retexture", "removed", "removed");
    document().setOption("frame/retexture-margin", 7.0, "margin");
    compareWithCommand({"--remove", "--margin", "7"}, "limit-angle");
    const QString plain = folder_.path() + "/plain.png";
    QVERIFY(QFile::copy(folder_.path() + "/in/frames/0007.png", plain));
    document().setOption("frame/retexture", "background", "background");
    settle();
    choose(plain);
    compareWithCommand({"--background", plain}, "limit-angle");
  }

  /// The picture follows a setting, a model, a frame, and stays equal to the command's.
  void itFollowsSettingsAndFrames() {
    turnOn();
    document().selectFrame(3);
    settle();
    const auto first = bar().result();
    QVERIFY(first);
    document().setSetting("predict.contour", std::string("star"));
    document().setSetting("detect.level", 0.4);
    settle();
    QVERIFY(bar().result() && bar().result() != first && bar().result()->picture.data != first->picture.data);
    compareWithCommand(
        {"--texture", folder_.path() + "/in/texture.png", "--set", "predict.contour=star", "--set", "detect.level=0.4"},
        document().plottedModel().c_str());
    document().undoStack()->undo();
    document().undoStack()->undo();
    settle();
    QVERIFY(bar().result()->picture.data == first->picture.data);
    document().selectFrame(4);
    settle();
    QVERIFY(bar().result()->picture.data != first->picture.data);
  }

  /// Each control is one step of undo, and the line in the picture, too; the session keeps them.
  void itIsUndoneAndKept() {
    turnOn();
    const int steps = document().undoStack()->count();
    FrameCanvas& c = canvas();
    const int width = c.photographSize().width();
    const QPoint line = c.widgetFromPixel({0.5 * width - 0.5, 100}).toPoint();
    drag(&c, {line, line + QPoint(20, 0), line + QPoint(60, 3)});
    QCOMPARE(document().undoStack()->count(), steps + 1);
    const double share = document().option("frame/retexture-compare", 0.5);
    QVERIFY2(std::abs(share - (0.5 + 60 / c.zoom() / width)) < 0.01, qPrintable(QString::number(share)));
    settle();
    // Left of the line stands the photograph, from it on the retextured frame: without overlays, at one screen pixel per pixel.
    for (const draw::OverlayLayer& layer : draw::overlayLayers()) document().setLayerVisible(layer.name, layer.title, false);
    constexpr double kZoom = 4;  // screen pixels are not smoothed
    c.lookAt(Pixel(share * width, 120), kZoom);
    settle();
    const QImage photograph(folder_.path() + "/in/frames/0000.png"), made = toQImage(bar().result()->picture),
                                                                     shown = c.grab().toImage();
    int checked = 0;
    for (int x = 0; x < photograph.width(); ++x)
      for (int y = 0; y < photograph.height(); y += 3) {
        const QPointF at = c.widgetFromPixel({double(x), double(y)});
        // Texts stand in the corners, and beside the line at the bottom.
        if (!QRectF(c.rect()).adjusted(4, 40, -4, -0.4 * c.height()).contains(at) || std::abs(x - share * width) < 3) continue;
        const QRgb is = shown.pixel((at * c.devicePixelRatioF()).toPoint());
        const QRgb expected = (x < share * width ? photograph : made).pixel(x, y);
        QVERIFY2(std::abs(qRed(is) - qRed(expected)) <= 1 && std::abs(qBlue(is) - qBlue(expected)) <= 1,
                 qPrintable(QStringLiteral("%1 %2").arg(x).arg(y)));
        ++checked;
      }
    QVERIFY(checked > 100);
    while (document().undoStack()->count() > steps && document().undoStack()->index() > steps) document().undoStack()->undo();
    QCOMPARE(document().option("frame/retexture-compare", 0.5), 0.5);
    const QString saved = folder_.path() + "/in/saved.glint";
    Opened state = document().toSave();
    coreEngine().save(state, document().inspection().get(), saved.toStdString(), {});
    window_->open(saved);
    settle();
    QVERIFY(bar().on() && bar().result());
    QVERIFY(canvas().comparing());
  }

  /// A session from others may not have any file of this computer read.
  void aFileOutsideIsReadOnlyWhereItIsAllowed() {
    const QString outside = folder_.path() + "/secret.png";
    writeChecked(outside, QColor(10, 20, 30));
    document().setOption("frame/retexture-texture", outside.toStdString(), "as from a session");
    document().setOption("frame/retexture", "texture", "on");
    settle();
    QVERIFY(!bar().result() && !canvas().comparing());
    QVERIFY2(words().contains("Allow and read") && words().contains("secret.png"), qPrintable(words()));
    emit label()->linkActivated(QStringLiteral("allow"));
    settle();
    QVERIFY2(bar().result() && canvas().comparing(), qPrintable(words()));
  }

  void whatCannotBeReadIsSaid() {
    QFile broken(folder_.path() + "/in/broken.png");
    QVERIFY(broken.open(QIODevice::WriteOnly) && broken.write("\x89PNG nothing") > 0);
    broken.close();
    document().setOption("frame/retexture", "texture", "on");
    document().setOption("frame/retexture-texture", "broken.png", "broken");
    settle();
    QVERIFY2(words().contains("broken.png") && !words().contains("Choose"), qPrintable(words()));
    QVERIFY(!canvas().comparing() && !bar().result());
    document().setOption("frame/retexture-background", "texture.png", "of another size");
    document().setOption("frame/retexture", "background", "background");
    settle();
    QVERIFY2(words().contains("128"), qPrintable(words()));
    QSignalSpy told(window_->exports(), &ExportActions::problem);
    window_->exports()->saveRetextured();
    QCOMPARE(told.count(), 1);
  }

  /// After many wishes in a row the last one counts, and the window answers meanwhile.
  void theNewestWins() {
    turnOn();
    for (int i = 1; i <= 30; ++i) document().setOption("frame/retexture-repeat", double(i), "more", 77);
    settle();
    compareWithCommand({"--texture", folder_.path() + "/in/texture.png", "--repeat", "30"}, document().plottedModel().c_str());
    for (int frame = 0; frame < 9; ++frame) document().selectFrame(frame);
    settle();
    QVERIFY(bar().result());
    compareWithCommand({"--texture", folder_.path() + "/in/texture.png", "--repeat", "30"}, document().plottedModel().c_str());
  }

  /// What the core says of a doubtful picture stands in words below the bar.
  void remarksAreShown() {
    turnOn();
    QVERIFY(bar().result() && !bar().result()->remarks.empty());
    for (const std::string& remark : bar().result()->remarks)
      QVERIFY2(words().contains(toQString(remark).toHtmlEscaped()), remark.c_str());
    document().setOption("frame/retexture", "off", "off");
    settle();
    QVERIFY(!bar().isVisible() && !label()->isVisible() && !canvas().comparing());
  }

 private:
  Document& document() { return window_->document(); }
  RetextureBar& bar() { return *window_->framePanel()->retexture(); }
  FrameCanvas& canvas() { return *window_->framePanel()->canvas(); }
  QLabel* label() { return window_->findChild<QLabel*>(QStringLiteral("retextureWords")); }
  QString words() { return label()->text(); }
  QWidget* tool() { return window_->framePanel()->findChild<QToolButton*>(QStringLiteral("retexture")); }
  std::string option(const char* name) { return document().option(name, std::string()); }
  void settle() { QTRY_VERIFY(document().inspection() && !document().stale() && window_->idle()); }
  void turnOn() {
    document().setOption("frame/retexture-texture", "texture.png", "texture");
    document().setOption("frame/retexture", "texture", "on");
    settle();
    QVERIFY2(bar().result(), qPrintable(words()));
  }
  /// Presses the button with the file's name and answers its dialog.
  void choose(const QString& file) {
    answerDialog(file, QDialogButtonBox::Open);
    QTest::mouseClick(bar().findChild<QToolButton*>(QStringLiteral("retextureFile")), Qt::LeftButton);
    answers_.reset();
    settle();
  }
  void answerDialog(const QString& file, QDialogButtonBox::StandardButton button) {
    answers_ = std::make_unique<QTimer>();
    connect(answers_.get(), &QTimer::timeout, this, [file, button] {
      auto* dialog = qobject_cast<QFileDialog*>(QApplication::activeModalWidget());
      if (!dialog) return;
      dialog->findChild<QLineEdit*>(QStringLiteral("fileNameEdit"))->setText(file);
      QTest::mouseClick(dialog->findChild<QDialogButtonBox*>()->button(button), Qt::LeftButton);
    });
    answers_->start(50);
  }
  void compareWithCommand(const QStringList& how, const char* model) {
    settle();
    QVERIFY2(bar().result(), qPrintable(words()));
    const QString mine = folder_.path() + "/mine.png", theirs = folder_.path() + "/theirs.png";
    QFile::remove(mine);
    answerDialog(mine, QDialogButtonBox::Save);
    QTest::mouseClick(bar().findChild<QToolButton*>(QStringLiteral("retextureSave")), Qt::LeftButton);
    answers_.reset();
    QTRY_VERIFY(QFile::exists(mine));
    const std::string id = document().scene()->frames[std::size_t(document().selection().frame)].id;
    QProcess glint;
    glint.start(QStringLiteral(GLINT_CLI),
                QStringList{"retexture", session_, "--frame", toQString(id), "--model", model, "-o", theirs} + how);
    QVERIFY(glint.waitForFinished(60000));
    QVERIFY2(glint.exitCode() == 0, glint.readAllStandardError().constData());
    QVERIFY(!contentOf(theirs).isEmpty());
    QVERIFY(contentOf(mine) == contentOf(theirs));
  }

  QTemporaryDir folder_;
  std::unique_ptr<MainWindow> window_;
  std::unique_ptr<QTimer> answers_;
  QString session_;
};

QObject* makeRetextureTest() { return new RetextureTest; }

}  // namespace glint::gui

#include "retexture_test.moc"
