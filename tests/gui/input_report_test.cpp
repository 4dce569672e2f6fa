// SPDX-License-Identifier: BSD-3-Clause
// The convention report in the window: what looks wrong is offered to be corrected, by real clicks.
#include "gui/window/input_report.h"

#include <QApplication>
#include <QDialogButtonBox>
#include <QFile>
#include <QFileDialog>
#include <QLineEdit>
#include <QPushButton>
#include <QTimer>

#include "core/scene/scene.h"
#include "gui/base/text.h"
#include "gui/window/main_window.h"
#include "gui/window/message_bar.h"
#include "tests/gui/fixture.h"

namespace glint::gui {

namespace {
/// Two cameras 2 m from a ball, to the right and left of it; stored as camera to world, which is the mistake.
const char* const kInverted = R"({"glint_scene": 1,
  "camera": {"width": 64, "height": 48, "fx": 80, "fy": 80, "cx": 31.5, "cy": 23.5},
  "frames": [{"id": "right", "camera_from_world": [[0,0,-1,2],[0,1,0,0],[1,0,0,0],[0,0,0,1]]},
             {"id": "left", "camera_from_world": [[0,0,1,-2],[0,1,0,0],[-1,0,0,0],[0,0,0,1]]}],
  "surfaces": {"ball": {"analytic": {"type": "sphere", "radius": 0.4}}}})";

QPushButton* shownButton(QWidget& in, const QString& text) {
  for (QPushButton* button : in.findChildren<QPushButton*>())
    if (button->isVisible() && button->text() == text) return button;
  return nullptr;
}
}  // namespace

class InputReportTest : public QObject {
  Q_OBJECT
 private slots:
  void init() { folder_ = std::make_unique<QTemporaryDir>(); }

  void aMistakeIsOfferedToBeCorrected() {
    const QString file = folder_->filePath("scene.json"), output = folder_->filePath("right.json");
    write(file, kInverted);
    MainWindow window(coreEngine());
    window.show();
    window.open(file);
    auto* bar = window.findChild<MessageBar*>(QStringLiteral("messageBar"));
    const QString fix = QString::fromUtf8("Invert the poses…");
    QTRY_VERIFY_WITH_TIMEOUT(shownButton(*bar, fix) && window.idle(), 20000);
    QVERIFY2(bar->text().contains("2 of 2 cameras do not see their surface"), qPrintable(bar->text()));
    // Its dock says the same, as `glint info` does.
    QTest::mouseClick(shownButton(*bar, "Show report"), Qt::LeftButton);
    ReportPanel* panel = window.report()->panel();
    QTRY_VERIFY(panel->isVisible());
    QVERIFY2(panel->text().contains("finding: 2 of 2 cameras do not see"), qPrintable(panel->text()));
    QTRY_VERIFY(shownButton(*panel, fix));  // new rows show with the next layout

    QTimer answers;
    connect(&answers, &QTimer::timeout, this, [&] {
      auto* dialog = qobject_cast<QFileDialog*>(QApplication::activeModalWidget());
      if (!dialog) return;
      dialog->findChild<QLineEdit*>(QStringLiteral("fileNameEdit"))->setText(output);
      QTest::mouseClick(dialog->findChild<QDialogButtonBox*>()->button(QDialogButtonBox::Save), Qt::LeftButton);
    });
    answers.start(50);
    QTest::mouseClick(shownButton(*panel, fix), Qt::LeftButton);
    QTRY_VERIFY_WITH_TIMEOUT(window.document().inputFile() == output && window.idle(), 20000);
    // By hand: the camera to the right looks along -x and has the ball 2 m before it.
    const Camera& right = window.document().scene()->frames[0].camera;
    QVERIFY((right.centreInWorld() - Eigen::Vector3d(2, 0, 0)).norm() < 1e-12);
    QVERIFY(std::abs(right.depth(Eigen::Vector3d::Zero()) - 2) < 1e-12);
    QTRY_VERIFY_WITH_TIMEOUT(window.report()->report(), 20000);
    QVERIFY(window.report()->report()->corrections.empty());
    QVERIFY(window.report()->report()->everyFrameSeesSurface());
    // The input is as it was.
    QFile input(file);
    QVERIFY(input.open(QIODevice::ReadOnly));
    QCOMPARE(input.readAll(), QByteArray(kInverted));
  }

  void theInputIsNotOverwritten() {
    const QString file = folder_->filePath("scene.json");
    write(file, kInverted);
    MainWindow window(coreEngine());
    window.show();
    window.open(file);
    QTRY_VERIFY_WITH_TIMEOUT(window.report()->report() && window.idle(), 20000);
    QTimer answers;
    connect(&answers, &QTimer::timeout, this, [&] {
      auto* dialog = qobject_cast<QFileDialog*>(QApplication::activeModalWidget());
      if (!dialog) return;
      dialog->findChild<QLineEdit*>(QStringLiteral("fileNameEdit"))->setText(file);
      QTest::mouseClick(dialog->findChild<QDialogButtonBox*>()->button(QDialogButtonBox::Save), Qt::LeftButton);
    });
    answers.start(50);
    window.report()->fix(window.report()->report()->corrections.at(0).correction);
    QVERIFY2(window.lastError().contains("is an input file"), qPrintable(window.lastError()));
    QFile input(file);
    QVERIFY(input.open(QIODevice::ReadOnly));
    QCOMPARE(input.readAll(), QByteArray(kInverted));
  }

  /// `glint info` has a word before it there.
  void onTheBarAFindingIsASentence() {
    const QString file = folder_->filePath("scene.json");
    write(file, R"({"glint_scene": 1, "camera": {"width": 64, "height": 48, "fx": 80, "fy": 80, "cx": 31.5, "cy": 23.5},
      "frames": [{"id": "right", "camera_from_world": [[0,0,1,0],[0,1,0,0],[-1,0,0,2],[0,0,0,1]]}],
      "surfaces": {"ball": {"analytic": {"type": "sphere", "radius": 0.4}}}})");
    MainWindow window(coreEngine());
    window.show();
    window.open(file);
    auto* bar = window.findChild<MessageBar*>(QStringLiteral("messageBar"));
    QTRY_VERIFY_WITH_TIMEOUT(window.report()->report() && window.idle(), 20000);
    QVERIFY2(bar->text().startsWith("Only one frame: nothing can be held out"), qPrintable(bar->text()));
    QVERIFY2(window.report()->panel()->text().contains("finding: only one frame: "),
             qPrintable(window.report()->panel()->text()));
  }

  void nothingIsOfferedWhereNothingIsWrong() {
    MainWindow window(coreEngine());
    window.show();
    window.open(QStringLiteral(GLINT_SOURCE_DIR "/sessions/ellipsoid/scene.json"));
    QTRY_VERIFY_WITH_TIMEOUT(window.report()->report() && window.idle(), 60000);
    QVERIFY(window.report()->report()->findings.empty());
    QVERIFY(window.findChild<MessageBar*>(QStringLiteral("messageBar"))->isHidden());
  }

 private:
  static void write(const QString& file, const QByteArray& content) {
    QFile f(file);
    QVERIFY(f.open(QIODevice::WriteOnly) && f.write(content) == content.size());
  }
  std::unique_ptr<QTemporaryDir> folder_;
};

QObject* makeInputReportTest() { return new InputReportTest; }

}  // namespace glint::gui

#include "input_report_test.moc"
