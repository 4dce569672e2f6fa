// SPDX-License-Identifier: BSD-3-Clause
// Photographs of mirror balls in their window, by real drags and clicks: outlines that are drawn and dragged, lamps whose truth
// is the reflection law written out here, and the same answer to the last bit as the command line's.
#include "gui/lamps/ball_window.h"

#include <QApplication>
#include <QClipboard>
#include <QDialogButtonBox>
#include <QDir>
#include <QFile>
#include <QFileDialog>
#include <QImage>
#include <QLabel>
#include <QLineEdit>
#include <QListWidget>
#include <QProcess>
#include <QPushButton>
#include <QTableView>
#include <QTimer>
#include <cmath>

#include "gui/base/number_box.h"
#include "gui/frame/frame_canvas.h"
#include "gui/lamps/ball_results.h"
#include "gui/lamps/lamp_table.h"
#include "gui/lamps/lamps_in_window.h"
#include "gui/lamps/lamps_panel.h"
#include "gui/plots/plot_canvas.h"
#include "gui/window/main_window.h"
#include "tests/gui/fixture.h"

namespace glint::gui {

namespace {

constexpr double kNearEnough = 0.3;  // degrees: a tenth of a pixel of a ball of 80 px is 0.07, its outline the rest
struct TrueBall {
  Eigen::Vector2d centre;
  double radius;
};
const std::vector<TrueBall> kTrueBalls{{{140, 130}, 90}, {{390, 118}, 80}};
const std::vector<Eigen::Vector3d> kTrueLamps{Eigen::Vector3d(0.5, -0.4, -0.8).normalized(),
                                              Eigen::Vector3d(-0.6, 0.3, -0.6).normalized(),
                                              Eigen::Vector3d(0.2, 0.5, -0.7).normalized()};

/// Dark balls before a bright wall, each with the clipped reflection of a distant lamp: its normal halves the angle to the
/// camera.
QImage shotUnder(const Eigen::Vector3d& lamp) {
  QImage image(520, 260, QImage::Format_RGB888);
  const Eigen::Vector2d normal = (lamp - Eigen::Vector3d::UnitZ()).normalized().head<2>();
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x) {
      double value = 150;
      for (const TrueBall& ball : kTrueBalls) {
        value += (40 - 150) / (1 + std::exp(-(ball.radius - (Eigen::Vector2d(x, y) - ball.centre).norm()) / 0.5));
        value += 600 * std::exp(-(Eigen::Vector2d(x, y) - ball.centre - ball.radius * normal).squaredNorm() / 40);
      }
      const int grey = std::min(255, int(value));
      image.setPixel(x, y, qRgb(grey, grey, grey));
    }
  return image;
}

double degreesBetween(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) * 180 / M_PI;
}

QByteArray bytesIn(const QString& file) {
  QFile f(file);
  return f.open(QIODevice::ReadOnly) ? f.readAll() : QByteArray();
}

}  // namespace

class BallWindowTest : public QObject {
  Q_OBJECT
 private slots:
  void init() {
    folder_ = std::make_unique<QTemporaryDir>();
    QVERIFY(QDir(folder_->path()).mkdir("shots"));
    for (std::size_t i = 0; i < kTrueLamps.size(); ++i)
      QVERIFY(shotUnder(kTrueLamps[i]).save(folder_->filePath(QStringLiteral("shots/s%1.png").arg(i))));
    main_ = std::make_unique<MainWindow>(coreEngine());
    main_->show();
  }
  void cleanup() { main_.reset(); }

  void drawnMeasuredAndTheSameAsTheCommand() {
    open();
    QVERIFY(!button("measureLamps")->isEnabled());  // no ball yet
    // The first outline is drawn without a button, a little off; the second after a button.
    dragOn({kTrueBalls[0].centre + Eigen::Vector2d(2, -1), kTrueBalls[0].centre + Eigen::Vector2d(50, 0),
            kTrueBalls[0].centre + Eigen::Vector2d(90, 0)});
    QCOMPARE(int(balls().size()), 1);
    QVERIFY(std::abs(balls()[0].outline.radius - 88) < 1.5);  // a screen pixel is about half a photograph's
    click("drawFromMiddle");
    dragOn({kTrueBalls[1].centre, kTrueBalls[1].centre + Eigen::Vector2d(0, 40), kTrueBalls[1].centre + Eigen::Vector2d(0, 82)});
    QCOMPARE(int(balls().size()), 2);
    // Its rim, then its middle, are dragged.
    const BallOutline before = balls()[1].outline;
    dragOn({before.centre + Eigen::Vector2d(before.radius, 0), before.centre + Eigen::Vector2d(60, 0),
            before.centre + Eigen::Vector2d(81, 0)});
    QVERIFY(std::abs(balls()[1].outline.radius - 81) < 1.5);
    dragOn({before.centre, before.centre + Eigen::Vector2d(20, 20), before.centre + Eigen::Vector2d(1, 1)});
    QVERIFY((balls()[1].outline.centre - before.centre - Eigen::Vector2d(1, 1)).norm() < 1.5);
    // It can also be set in numbers.
    auto* x = window_->findChild<NumberBox*>(QStringLiteral("ballX"));
    x->setFocus();
    x->selectAll();
    QTest::keyClicks(x, "390.5");
    QTest::keyClick(x, Qt::Key_Return);
    QCOMPARE(balls()[1].outline.centre.x(), 390.5);

    click("measureLamps");
    QTRY_VERIFY_WITH_TIMEOUT(window_->report() && window_->idle(), 120000);
    const std::shared_ptr<const LampsReport> report = window_->report();
    QCOMPARE(int(report->lamps.size()), int(kTrueLamps.size()));
    for (std::size_t i = 0; i < kTrueLamps.size(); ++i) {
      QVERIFY2(!report->lamps[i].failure, report->lamps[i].id.c_str());
      QVERIFY2(degreesBetween(report->lamps[i].direction, kTrueLamps[i]) < kNearEnough,
               qPrintable(QString::number(degreesBetween(report->lamps[i].direction, kTrueLamps[i]))));
    }
    // Refined outlines are shown: they are within a pixel of the truth, which those drawn by hand were not.
    QCOMPARE(int(report->balls->balls.size()), 2);
    for (const Pixel& p : report->balls->balls[0].outline)
      QVERIFY(std::abs((p - kTrueBalls[0].centre).norm() - kTrueBalls[0].radius) < 1);
    sameAsTheCommand();
    selectsBothWays();
    QCOMPARE(window_->results()->balls()->model()->rowCount(), 2);
    QVERIFY(window_->results()->residuals()->plot().empty.empty());
    changesAreMarked();
  }

  /// One step for each gesture, by keys and by buttons, wherever the focus is.
  void changesAreTakenBackStepByStep() {
    open();
    QApplication::setActiveWindow(window_);  // there is no window manager: keys of undo belong to the active window
    const auto state = [this] {
      QString text;
      for (const BallOutlines::Ball& b : balls())
        text += QStringLiteral("%1 %2 %3;").arg(b.outline.centre.x()).arg(b.outline.centre.y()).arg(b.outline.radius);
      return text;
    };
    QStringList states{state()};
    QVERIFY(!button("undoOutline")->isEnabled());
    dragOn({kTrueBalls[0].centre, kTrueBalls[0].centre + Eigen::Vector2d(50, 0), kTrueBalls[0].centre + Eigen::Vector2d(90, 0)});
    states << state();
    dragOn({balls()[0].outline.centre, balls()[0].outline.centre + Eigen::Vector2d(30, 5),
            balls()[0].outline.centre + Eigen::Vector2d(12, 7)});  // several moves of the mouse
    states << state();
    click("addBall");
    states << state();
    auto* x = window_->findChild<NumberBox*>(QStringLiteral("ballX"));
    x->setFocus();
    x->selectAll();
    QTest::keyClicks(x, "390.5");
    QTest::keyClick(x, Qt::Key_Return);
    for (int i = 0; i < 3; ++i) QTest::keyClick(x, Qt::Key_Up);
    states << state();
    click("removeBall");
    states << state();
    for (int i = 1; i < int(states.size()); ++i) QVERIFY(states[i] != states[i - 1]);
    for (int i = int(states.size()) - 2; i >= 0; --i) {
      if (i % 2)
        QTest::keyClick(window_->focusWidget(), Qt::Key_Z, Qt::ControlModifier);
      else
        click("undoOutline");
      QCOMPARE(state(), states[i]);
    }
    QVERIFY(!button("undoOutline")->isEnabled());
    QTest::keyClick(window_->canvas(), Qt::Key_Z, Qt::ControlModifier);  // nothing more
    QCOMPARE(state(), states[0]);
    for (int i = 1; i < int(states.size()); ++i) {
      if (i % 2)
        QTest::keyClick(window_->canvas(), Qt::Key_Z, Qt::ControlModifier | Qt::ShiftModifier);
      else
        click("redoOutline");
      QCOMPARE(state(), states[i]);
    }
    QVERIFY(!button("redoOutline")->isEnabled());
    // A new step after undo leaves nothing to redo.
    click("undoOutline");
    click("addBall");
    QVERIFY(!button("redoOutline")->isEnabled());
    // Other photographs begin anew.
    main_->lamps()->openBalls(folder_->filePath("shots"));
    QVERIFY(balls().empty() && !button("undoOutline")->isEnabled());
  }

  void threePointsOfTheRimMakeABall() {
    open();
    click("drawThroughRim");
    for (const double degrees : {10.0, 130.0, 250.0}) {
      const double t = degrees * M_PI / 180;
      clickOn(kTrueBalls[0].centre + 90 * Eigen::Vector2d(std::cos(t), std::sin(t)));
    }
    QCOMPARE(int(balls().size()), 1);
    QVERIFY((balls()[0].outline.centre - kTrueBalls[0].centre).norm() < 1);
    QVERIFY(std::abs(balls()[0].outline.radius - 90) < 1);
    // Three points on a line give no circle, and a message says so.
    click("drawThroughRim");
    for (const double at : {100.0, 150.0, 200.0}) clickOn({at, 30});
    QCOMPARE(int(balls().size()), 1);
    QVERIFY(window_->findChild<QLabel*>(QStringLiteral("ballStatus"))->text().contains("on a line"));
    click("removeBall");
    QVERIFY(balls().empty());
    QVERIFY(!button("measureLamps")->isEnabled());
    // One step back brings the outline, the next one the tool that drew it.
    click("undoOutline");
    QCOMPARE(int(balls().size()), 1);
    click("undoOutline");
    QVERIFY(balls().empty() && button("drawThroughRim")->isChecked());
  }

  void whatCannotBeTakenIsSaid() {
    open();
    click("addBall");
    auto* camera = window_->findChild<QLineEdit*>(QStringLiteral("ballCamera"));
    QTest::keyClicks(camera, "2000,2000");
    click("measureLamps");
    QVERIFY(window_->idle() && !window_->report());
    QTRY_VERIFY(window_->findChild<QLabel*>(QStringLiteral("complaint")));
    // The message names the field and the reason, and the field can be typed in again at once.
    const auto told = [this] { return window_->findChild<QLabel*>(QStringLiteral("ballStatus"))->text(); };
    QCOMPARE(told(), QStringLiteral("Camera, pixels: expected fx,fy,cx,cy or fx,fy,cx,cy,k1,k2,p1,p2[,k3]"));
    QCOMPARE(window_->focusWidget(), static_cast<QWidget*>(camera));
    QCOMPARE(camera->selectedText(), camera->text());
    QApplication::clipboard()->setText(QStringLiteral("untouched"));
    window_->findChild<QListWidget*>(QStringLiteral("ballPhotographs"))->setFocus();
    click("copyLightsCommand");
    QCOMPARE(QApplication::clipboard()->text(), QStringLiteral("untouched"));
    QVERIFY(told().startsWith(QStringLiteral("Camera, pixels: ")));
    QCOMPARE(window_->focusWidget(), static_cast<QWidget*>(camera));
    camera->clear();
    auto* metres = window_->findChild<QLineEdit*>(QStringLiteral("ballRadius"));
    QTest::keyClicks(metres, "-2");
    click("measureLamps");
    QCOMPARE(told(), QStringLiteral("Ball radius, metres: must be above 0"));
    QCOMPARE(window_->focusWidget(), static_cast<QWidget*>(metres));
    metres->clear();
    // An outline where no ball is gives the reason in place of an answer, and nothing of an earlier one stays.
    auto* radius = window_->findChild<NumberBox*>(QStringLiteral("ballRadiusPx"));
    radius->setValue(20);
    window_->findChild<NumberBox*>(QStringLiteral("ballX"))->setValue(262);
    window_->findChild<NumberBox*>(QStringLiteral("ballY"))->setValue(225);
    click("measureLamps");
    QTRY_VERIFY_WITH_TIMEOUT(window_->idle(), 120000);
    QVERIFY(!window_->findChild<QLabel*>(QStringLiteral("ballStatus"))->text().isEmpty());
    // The words are the window's, which has no options of a command line.
    const auto said = [this] { return window_->findChild<QLabel*>(QStringLiteral("ballStatus"))->text(); };
    window_->findChild<NumberBox*>(QStringLiteral("ballX"))->setValue(2000);
    click("measureLamps");
    QTRY_VERIFY_WITH_TIMEOUT(window_->idle(), 120000);
    QVERIFY2(said().contains("the ball at 2000,225") && said().contains("outside of its photographs") && !said().contains("--"),
             qPrintable(said()));
    click("addBall");
    click("addBall");
    click("measureLamps");
    QTRY_VERIFY_WITH_TIMEOUT(window_->idle(), 120000);
    QVERIFY2(said().contains("is the same ball as the ball at") && !said().contains("--"), qPrintable(said()));
    auto* photographs = window_->findChild<QListWidget*>(QStringLiteral("ballPhotographs"));
    click("removeBall");
    for (int i = 0; i < photographs->count(); ++i) photographs->item(i)->setCheckState(Qt::Unchecked);
    click("measureLamps");
    QVERIFY(window_->idle());
    QVERIFY2(said().contains("No photograph is ticked"), qPrintable(said()));
    // A folder without photographs.
    main_->lamps()->openBalls(QStringLiteral(GLINT_SOURCE_DIR "/cli"));
    QVERIFY2(main_->lastError().contains("no photographs"), qPrintable(main_->lastError()));
  }

  void everythingHasAName() {
    open();
    for (QWidget* w : window_->findChildren<QWidget*>()) {
      if (!(w->focusPolicy() & Qt::TabFocus) || !w->isVisible()) continue;
      const bool named = !w->accessibleName().isEmpty() || w->property("text").toString() != QString() ||
                         qobject_cast<QTabBar*>(w) || w->objectName().startsWith(QLatin1String("qt_"));
      QVERIFY2(named, qPrintable(w->metaObject()->className() + QStringLiteral(" ") + w->objectName()));
    }
  }

 private:
  void open() {
    main_->lamps()->openBalls(folder_->filePath("shots"));
    window_ = main_->lamps()->balls();
    QVERIFY(window_);
    QVERIFY(QTest::qWaitForWindowExposed(window_));
    QTRY_VERIFY(window_->idle() && window_->canvas()->hasPicture());
  }
  const std::vector<BallOutlines::Ball>& balls() const { return window_->outlines().balls(); }
  QPushButton* button(const char* name) const { return window_->findChild<QPushButton*>(QLatin1String(name)); }
  void click(const char* name) { QTest::mouseClick(button(name), Qt::LeftButton); }
  QPoint onCanvas(const Eigen::Vector2d& pixel) const { return window_->canvas()->widgetFromPixel(pixel).toPoint(); }
  void dragOn(const std::vector<Eigen::Vector2d>& pixels) {
    std::vector<QPoint> points;
    for (const Eigen::Vector2d& p : pixels) points.push_back(onCanvas(p));
    drag(window_->canvas(), points);
  }
  void clickOn(const Eigen::Vector2d& pixel) { QTest::mouseClick(window_->canvas(), Qt::LeftButton, {}, onCanvas(pixel)); }

  /// Every file that can be saved has the bytes that the copied command writes.
  void sameAsTheCommand() {
    for (const char* ending : {".json", ".lp", ".csv"}) sameAsTheCommand(QLatin1String(ending));
  }
  void sameAsTheCommand(const QString& ending) {
    const QString saved = folder_->filePath(QStringLiteral("window%1").arg(++saves_) + ending),
                  written = folder_->filePath("command" + ending);
    QTimer answers;
    connect(&answers, &QTimer::timeout, this, [&] {
      auto* dialog = qobject_cast<QFileDialog*>(QApplication::activeModalWidget());
      if (!dialog) return;
      dialog->findChild<QLineEdit*>(QStringLiteral("fileNameEdit"))->setText(saved);
      QTest::mouseClick(dialog->findChild<QDialogButtonBox*>()->button(QDialogButtonBox::Save), Qt::LeftButton);
    });
    answers.start(50);
    click("saveLamps");
    answers.stop();
    click("copyLightsCommand");
    const QString command = QApplication::clipboard()->text();
    QVERIFY2(command.startsWith("glint lights "), qPrintable(command));
    QProcess program;
    program.start("sh", {"-c", QStringLiteral(GLINT_CLI) + command.mid(5) + " -o " + written});
    QVERIFY(program.waitForFinished(120000));
    QVERIFY2(program.exitCode() == 0, program.readAllStandardError().constData());
    QVERIFY(bytesIn(written).size() > 60);
    QCOMPARE(bytesIn(saved), bytesIn(written));
    if (ending == QLatin1String(".lp")) {  // a line for each photograph that was measured, after their number
      const QList<QByteArray> lines = bytesIn(saved).trimmed().split('\n');
      QCOMPARE(lines.front().toInt(), int(window_->report()->lamps.size()));
      QCOMPARE(lines.size(), 1 + int(window_->report()->lamps.size()));
      QVERIFY2(lines.back().startsWith("s2.png "), lines.back().constData());
    }
  }

  void selectsBothWays() {
    auto* photographs = window_->findChild<QListWidget*>(QStringLiteral("ballPhotographs"));
    LampTable* table = window_->results()->lamps()->table();
    QTest::mouseClick(table->viewport(), Qt::LeftButton, {}, table->visualRect(table->model()->index(2, 0)).center());
    QCOMPARE(photographs->currentRow(), 2);
    photographs->setCurrentRow(1);
    QCOMPARE(table->currentLamp(), 1);
    QTRY_VERIFY(window_->idle());
  }

  /// A photograph that is left out is not measured; until then the numbers say that they are older.
  void changesAreMarked() {
    auto* photographs = window_->findChild<QListWidget*>(QStringLiteral("ballPhotographs"));
    photographs->item(0)->setCheckState(Qt::Unchecked);
    auto* badge = window_->results()->lamps()->findChild<QLabel*>(QStringLiteral("staleBadge"));
    QTRY_VERIFY(badge->isVisible());
    click("measureLamps");
    QTRY_VERIFY_WITH_TIMEOUT(window_->idle() && window_->report()->lamps.size() == 2, 120000);
    QTRY_VERIFY(!badge->isVisible());
    sameAsTheCommand();
  }

  std::unique_ptr<QTemporaryDir> folder_;
  std::unique_ptr<MainWindow> main_;
  BallWindow* window_ = nullptr;
  int saves_ = 0;
};

QObject* makeBallWindowTest() { return new BallWindowTest; }

}  // namespace glint::gui

#include "ball_window_test.moc"
