// SPDX-License-Identifier: BSD-3-Clause
// Captures of other programs in the window: what their files leave open is asked for, and a session keeps the answer.
#include <QApplication>
#include <QDialogButtonBox>
#include <QDir>
#include <QFile>
#include <QFileDialog>
#include <QInputDialog>
#include <QLineEdit>
#include <QPushButton>
#include <QTimer>

#include "core/app/session.h"
#include "gui/base/text.h"
#include "gui/document/session_file.h"
#include "gui/window/command_line.h"
#include "gui/window/file_actions.h"
#include "gui/window/main_window.h"
#include "gui/window/message_bar.h"
#include "tests/gui/fixture.h"

namespace glint::gui {

namespace {
const char* const kMesh =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty double y\nproperty double z\n"
    "element face 1\nproperty list uchar int vertex_indices\nend_header\n-1 -1 0\n1 -1 0\n0 1 0\n3 0 1 2\n";

void put(const QString& file, const QByteArray& content) {
  QVERIFY(QDir().mkpath(QFileInfo(file).path()));
  QFile f(file);
  QVERIFY(f.open(QIODevice::WriteOnly) && f.write(content) == content.size());
}

void putColmap(const QString& folder) {
  put(folder + "/sparse/0/cameras.txt", "1 PINHOLE 64 48 80 80 32 24\n");
  put(folder + "/sparse/0/images.txt", "1 1 0 0 0 0 0 3 1 a.png\n\n2 1 0 0 0 0 0 2 1 b.png\n\n");
  put(folder + "/sparse/0/points3D.txt", "");
}

/// Two photographs of a TUM capture, which say no intrinsics.
void putTum(const QString& folder) {
  QImage grey(64, 48, QImage::Format_Grayscale8);
  grey.fill(100);
  QVERIFY(QDir().mkpath(folder + "/rgb") && grey.save(folder + "/rgb/1.0.png") && grey.save(folder + "/rgb/2.0.png"));
  put(folder + "/rgb.txt", "1.0 rgb/1.0.png\n2.0 rgb/2.0.png\n");
  put(folder + "/groundtruth.txt", "1.0 0 0 -2 0 0 0 1\n2.0 0 0 -3 0 0 0 1\n");
  put(folder + "/depth.txt", "");
  put(folder + "/mesh.ply", kMesh);
}

QPushButton* buttonOf(MainWindow& window, const QString& text) {
  auto* bar = window.findChild<MessageBar*>(QStringLiteral("messageBar"));
  for (QPushButton* button : bar->findChildren<QPushButton*>())
    if (bar->isVisible() && button->isVisible() && button->text() == text) return button;
  return nullptr;
}

/// Clicks the button once it is there.
bool press(MainWindow& window, const QString& text) {
  QPushButton* button = nullptr;
  if (!QTest::qWaitFor([&] { return (button = buttonOf(window, text)) != nullptr && window.idle(); }, 20000)) return false;
  QTest::mouseClick(button, Qt::LeftButton);
  return true;
}
}  // namespace

class CapturesTest : public QObject {
  Q_OBJECT
 private slots:
  void init() { folder_ = std::make_unique<QTemporaryDir>(); }
  void cleanup() { timers_.reset(); }

  void severalMeshesAreButtons() {
    putColmap(path(""));
    put(path("one.ply"), kMesh);
    put(path("two.ply"), kMesh);
    MainWindow window(coreEngine());
    window.show();
    window.open(path(""));
    QVERIFY2(press(window, "two.ply"), qPrintable(window.lastError()));
    QTRY_VERIFY_WITH_TIMEOUT(window.document().scene() && window.idle(), 20000);
    QCOMPARE(toQString(window.document().scene()->surfaces.begin()->second.file()->named), QStringLiteral("two.ply"));
    QCOMPARE(window.document().scene()->frames.size(), std::size_t(2));
    // The session keeps the answer: opening it asks nothing.
    QVERIFY(window.findChild<FileActions*>()->saveAsTo(path("x.glint")));
    QTRY_VERIFY_WITH_TIMEOUT(QFile::exists(path("x.glint")) && window.idle(), 20000);
    QCOMPARE(openSession(path("x.glint").toStdString()).scene->surfaces.begin()->second.file()->named, std::string("two.ply"));
  }

  void aMeshCanBeChosen() {
    QTemporaryDir elsewhere;
    putColmap(path(""));
    put(elsewhere.filePath("object.ply"), kMesh);
    MainWindow window(coreEngine());
    window.show();
    window.open(path(""));
    answerDialog<QFileDialog>([](QFileDialog& dialog) { dialog.reject(); });
    QVERIFY2(press(window, QString::fromUtf8("Choose mesh…")), qPrintable(window.lastError()));
    // After Cancel the question can be found again.
    answerDialog<QFileDialog>([&](QFileDialog& dialog) {
      auto* name = dialog.findChild<QLineEdit*>(QStringLiteral("fileNameEdit"));
      name->setText(elsewhere.filePath("object.ply"));
      QTest::mouseClick(dialog.findChild<QDialogButtonBox*>()->button(QDialogButtonBox::Open), Qt::LeftButton);
    });
    QVERIFY2(press(window, QString::fromUtf8("Choose mesh…")), qPrintable(window.lastError()));
    QTRY_VERIFY_WITH_TIMEOUT(window.document().scene() && window.idle(), 20000);
    QCOMPARE(toQString(window.document().scene()->surfaces.begin()->second.file()->file.string()),
             elsewhere.filePath("object.ply"));
  }

  /// A person who opens the folder one level too high is led to the right one.
  void aFolderInsideIsOffered() {
    putColmap(path("work/model"));
    put(path("work/notes.txt"), "nothing");
    put(path("work/model/object.ply"), kMesh);
    MainWindow window(coreEngine());
    window.show();
    window.open(path("work"));
    QTRY_VERIFY2(window.lastError().endsWith("its folder 'model' is: COLMAP model"), qPrintable(window.lastError()));
    QVERIFY2(press(window, QStringLiteral("Open 'model' (COLMAP model)")), qPrintable(window.lastError()));
    QTRY_VERIFY_WITH_TIMEOUT(window.document().scene() && window.idle(), 20000);
    QCOMPARE(window.document().inputFile(), path("work/model"));
  }

  // A folder of images says neither poses nor intrinsics: two questions, one after the other.
  void posesOfImagesAreChosen() {
    QImage grey(64, 48, QImage::Format_Grayscale8);
    grey.fill(100);
    QVERIFY(QDir().mkpath(path("frames")) && grey.save(path("frames/1.0.png")) && grey.save(path("frames/2.0.png")));
    put(path("frames/mesh.ply"), kMesh);
    QTemporaryDir elsewhere;
    put(elsewhere.filePath("tracked.txt"), "1.0 0 0 -2 0 0 0 1\n2.0 0 0 -3 0 0 0 1\n");
    MainWindow window(coreEngine());
    window.show();
    window.open(path("frames"));
    answerDialog<QFileDialog>([&](QFileDialog& dialog) {
      dialog.findChild<QLineEdit*>(QStringLiteral("fileNameEdit"))->setText(elsewhere.filePath("tracked.txt"));
      QTest::mouseClick(dialog.findChild<QDialogButtonBox*>()->button(QDialogButtonBox::Open), Qt::LeftButton);
    });
    QVERIFY2(press(window, QString::fromUtf8("Choose poses…")), qPrintable(window.lastError()));
    timers_.reset();
    answerDialog<QInputDialog>([](QInputDialog& dialog) {
      dialog.setTextValue("80, 80, 31.5, 23.5");
      dialog.accept();
    });
    QVERIFY2(press(window, QString::fromUtf8("Enter intrinsics…")), qPrintable(window.lastError()));
    QTRY_VERIFY_WITH_TIMEOUT(window.document().scene() && window.idle(), 20000);
    QCOMPARE(window.document().scene()->frames.size(), std::size_t(2));
    QVERIFY(std::abs(window.document().scene()->frames[1].camera.centreInWorld().z() + 3) < 1e-12);
    QCOMPARE(window.document().scene()->frames[0].camera.pixelFromRay(0, 0), 80.0);
  }

  void intrinsicsAreAskedForAndAskedAgainWhenTheyAreNone() {
    putTum(path(""));
    MainWindow window(coreEngine());
    window.show();
    window.open(path(""));
    int asked = 0;
    answerDialog<QInputDialog>([&](QInputDialog& dialog) {
      dialog.setTextValue(++asked == 1 ? "80,80" : "80, 80, 31.5, 23.5");
      dialog.accept();
    });
    QVERIFY2(press(window, QString::fromUtf8("Enter intrinsics…")), qPrintable(window.lastError()));
    QTRY_VERIFY_WITH_TIMEOUT(window.document().scene() && window.idle(), 20000);
    QCOMPARE(asked, 2);
    QCOMPARE(window.document().scene()->frames[0].camera.pixelFromRay(0, 2), 31.5);
  }

  void twoReadingsAreButtons() {
    putColmap(path(""));
    putTum(path(""));
    MainWindow window(coreEngine());
    window.show();
    window.open(path(""));
    QTRY_VERIFY_WITH_TIMEOUT(window.lastError().contains("can be read in several ways"), 20000);
    QPushButton* button = nullptr;
    for (QPushButton* b : window.findChild<MessageBar*>(QStringLiteral("messageBar"))->findChildren<QPushButton*>())
      if (b->isVisible() && b->text().contains("COLMAP")) button = b;
    QVERIFY(button);
    QTest::mouseClick(button, Qt::LeftButton);
    QTRY_VERIFY_WITH_TIMEOUT(window.document().scene() && window.idle(), 20000);
    QCOMPARE(window.document().scene()->kind, std::string("colmap"));
  }

  void theCommandLineAnswers() {
    const CommandLine c = parseCommandLine({"x", "--camera", "80,80,31.5,23.5", "--units=mm", "--surface", "depth"});
    QCOMPARE(c.choices.camera.size(), std::size_t(4));
    QCOMPARE(*c.choices.metresPerUnit, 0.001);
    QVERIFY(c.choices.surface == InputChoices::Surface::Depth);
    QVERIFY_EXCEPTION_THROWN(parseCommandLine({"x", "--units", "inch"}), InputError);
    QVERIFY(helpText().contains("--surface FILE|depth"));
  }

 private:
  /// Answers every dialog of this kind that opens until the test ends.
  template <class Dialog, class Answer>
  void answerDialog(Answer answer) {
    auto* timer = new QTimer(folderTimers());
    connect(timer, &QTimer::timeout, this, [answer]() mutable {
      if (auto* dialog = qobject_cast<Dialog*>(QApplication::activeModalWidget())) answer(*dialog);
    });
    timer->start(50);
  }
  /// Owns the timers of one test.
  QObject* folderTimers() {
    timers_ = std::make_unique<QObject>();
    return timers_.get();
  }
  QString path(const QString& name) const { return name.isEmpty() ? folder_->path() : folder_->filePath(name); }
  std::unique_ptr<QTemporaryDir> folder_;
  std::unique_ptr<QObject> timers_;
};

QObject* makeCapturesTest() { return new CapturesTest; }

}  // namespace glint::gui

#include "captures_test.moc"
