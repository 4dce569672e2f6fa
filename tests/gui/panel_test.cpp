// SPDX-License-Identifier: BSD-3-Clause
#include <QComboBox>
#include <QDoubleSpinBox>
#include <QLineEdit>
#include <QSignalSpy>
#include <QSlider>
#include <QStyle>
#include <QStyleOptionSlider>
#include <QToolButton>
#include <QTreeWidget>

#include "gui/base/number_box.h"
#include "gui/base/number_delegate.h"
#include "gui/base/text.h"
#include "gui/document/document.h"
#include "gui/panels/parameter_panel.h"
#include "gui/panels/selection_text.h"
#include "tests/core/pipeline/exact_scene.h"
#include "tests/gui/fixture.h"

namespace glint::gui {

class PanelTest : public QObject {
  Q_OBJECT
 private slots:
  void init() {
    document_ = std::make_unique<Document>(parseTrainSpec);
    panel_ = std::make_unique<ParameterPanel>(*document_);
    document_->open(fixture_.opened());
    panel_->resize(380, 700);
    panel_->show();
    QVERIFY(QTest::qWaitForWindowExposed(panel_.get()));
    panel_->activateWindow();
  }

  void everySettingHasItsRow() {
    QVERIFY(!allParams().empty());
    for (const ParamSpec& spec : allParams()) {
      QVERIFY2(panel_->findChild<QWidget*>("value:" + toQString(spec.key)), spec.key.c_str());
      QVERIFY2(panel_->findChild<QToolButton*>("reset:" + toQString(spec.key)), spec.key.c_str());
    }
  }

  void typingIsOneStep() {
    auto* box = panel_->findChild<QDoubleSpinBox*>("value:detect.level");
    QVERIFY(box);
    box->setFocus();
    box->selectAll();
    QTest::keyClicks(box, "0.37");
    QCOMPARE(document_->undoStack()->count(), 0);  // nothing before the typing is finished
    QTest::keyClick(box, Qt::Key_Return);
    QCOMPARE(document_->request().settings.number("detect.level"), 0.37);
    QCOMPARE(document_->undoStack()->count(), 1);
    document_->undoStack()->undo();
    QCOMPARE(document_->request().settings.number("detect.level"), 0.5);
    QCOMPARE(box->value(), 0.5);
  }

  void aDragIsOneStep() {
    auto* slider = panel_->findChild<QSlider*>("slider:detect.level");
    QVERIFY(slider);
    QStyleOptionSlider option;
    option.initFrom(slider);
    option.minimum = slider->minimum();
    option.maximum = slider->maximum();
    option.sliderPosition = option.sliderValue = slider->value();
    const QPoint handle = slider->style()->subControlRect(QStyle::CC_Slider, &option, QStyle::SC_SliderHandle, slider).center();
    std::vector<QPoint> path;
    for (int dx = 0; dx <= 20; dx += 4) path.push_back(handle + QPoint(dx, 0));
    QSignalSpy values(document_.get(), &Document::requestChanged);
    drag(slider, path);
    QVERIFY(values.count() > 2);  // several values in one step
    const double after = document_->request().settings.number("detect.level");
    QVERIFY(after > 0.5);
    QCOMPARE(document_->undoStack()->count(), 1);
    const InspectionRequest end = document_->request();
    document_->undoStack()->undo();
    QCOMPARE(document_->request().settings.number("detect.level"), 0.5);
    document_->undoStack()->redo();  // the end of the drag, not its first value
    QCOMPARE(document_->request().settings.number("detect.level"), after);
    QVERIFY(document_->request() == end);
    drag(slider, {path.back(), path[2], path[1]});  // a second drag is a second step
    QCOMPARE(document_->undoStack()->count(), 2);
    const double second = document_->request().settings.number("detect.level");
    QVERIFY(second < after);
    document_->undoStack()->undo();
    QCOMPARE(document_->request().settings.number("detect.level"), after);
    document_->undoStack()->undo();
    QCOMPARE(document_->request().settings.number("detect.level"), 0.5);
    document_->undoStack()->redo();
    QCOMPARE(document_->request().settings.number("detect.level"), after);
    document_->undoStack()->redo();
    QCOMPARE(document_->request().settings.number("detect.level"), second);
  }

  void choicesAndReset() {
    auto* combo = panel_->findChild<QComboBox*>("value:light.solver");
    auto* reset = panel_->findChild<QToolButton*>("reset:light.solver");
    QVERIFY(combo && reset);
    QVERIFY(!reset->isEnabled());
    combo->setFocus();
    QTest::keyClick(combo, Qt::Key_Up);
    QCOMPARE(document_->request().settings.text("light.solver"), std::string("triangulated"));
    QVERIFY(reset->isEnabled());
    QTest::mouseClick(reset, Qt::LeftButton);
    QCOMPARE(document_->request().settings.text("light.solver"), std::string("bundle"));
    QCOMPARE(combo->currentText(), QStringLiteral("bundle"));
    QCOMPARE(document_->undoStack()->count(), 2);
  }

  void smallNumbersAreTypedAndShownShort() {
    auto* box = panel_->findChild<NumberBox*>("value:predict.walk_tolerance");
    QVERIFY(box);
    QCOMPARE(box->text(), QStringLiteral("1e-10 rad"));
    box->setFocus();
    box->selectAll();
    QTest::keyClicks(box, "2e-8");
    QTest::keyClick(box, Qt::Key_Return);
    QCOMPARE(document_->request().settings.number("predict.walk_tolerance"), 2e-8);
  }

  void outOfRangeIsNotTaken() {
    auto* box = panel_->findChild<QDoubleSpinBox*>("value:detect.level");
    box->setFocus();
    box->selectAll();
    QTest::keyClicks(box, "7");
    QTest::keyClick(box, Qt::Key_Return);
    QVERIFY(document_->request().settings.number("detect.level") <= 0.98);
  }

  void sliderScalesReachBothEndsAndEveryDefault() {
    for (const ParamSpec& spec : allParams()) {
      if (!(spec.max > spec.min)) continue;
      const SliderScale scale(spec);
      QCOMPARE(scale.value(0), spec.min);
      QCOMPARE(scale.value(SliderScale::kPositions), spec.max);
      for (int p = 1; p <= SliderScale::kPositions; ++p) QVERIFY2(scale.value(p) >= scale.value(p - 1), spec.key.c_str());
    }
  }

  void numbersNameFilesWithinTheSceneWithoutItsFolder() {
    Inspection inspection = drawnCircles(document_->sharedScene(), document_->request());
    const std::string folder = document_->scene()->folder.string();
    inspection.evidence[0].highlights.clear();
    inspection.evidence[0].failure = Failure{Reason::FrameUnreadable, folder + "/0000.png: cannot be read"};
    QString all;
    for (const NumberGroup& group : describeSelection(inspection, {0, "canonical"}, "canonical")) all += group.lines;
    QVERIFY2(all.contains("unreadable: 0000.png: cannot be read"), qPrintable(all));
    QVERIFY(!all.contains(toQString(folder)));
  }

  /// First of all numbers: in whose coordinates a flash is, where, how sure that is, and what each of both assumptions leaves.
  void numbersOfAFlashAreOfTheCamera() {
    using namespace testing_support;
    const std::shared_ptr<const Scene> scene = flashLitScene(sphere(0.5), 9);
    InspectionRequest request;
    request.models = {"limit-angle"};
    request.train = "0-5";
    request.noisePx = 0.05;
    const Inspection carried = inspect(scene, request);
    const NumberGroup first = describeSelection(carried, {7, "limit-angle"}, "limit-angle").front();
    QCOMPARE(first.title, QStringLiteral("Light lamp, in the camera's coordinates"));
    const QStringList lines = first.lines.split('\n');
    const auto three = [&](const QString& start) {
      Eigen::Vector3d v(NAN, NAN, NAN);
      for (const QString& line : lines)
        if (const QStringList parts = line.split(' ', Qt::SkipEmptyParts); line.startsWith(start) && parts.size() == 6)
          for (int i = 0; i < 3; ++i) v(i) = parts[2 + i].toDouble();
      return v;
    };
    const Eigen::Vector3d at = three(QStringLiteral("L = ")), sigma = three(QString::fromUtf8("± = "));
    for (int i = 0; i < 3; ++i) QVERIFY2(std::abs(at(i) - kFlashInCamera(i)) < 5 * sigma(i), qPrintable(first.lines));
    QVERIFY2(sigma.maxCoeff() < 0.05, qPrintable(first.lines));
    QVERIFY2(!lines.filter(QStringLiteral("with camera = misses the peaks by ")).isEmpty(), qPrintable(first.lines));
    QVERIFY2(!lines.filter(QStringLiteral("at rest = misses the peaks by ")).isEmpty(), qPrintable(first.lines));
    // A statement that they contradict shows both as well, also where nothing answers.
    request.settings.set("light.frame", std::string("world"));
    const NumberGroup doubted = describeSelection(inspect(scene, request), {7, "limit-angle"}, "limit-angle").front();
    QCOMPARE(doubted.title, QStringLiteral("Light lamp"));
    QVERIFY2(doubted.lines.contains(QStringLiteral("with camera = misses the peaks by ")), qPrintable(doubted.lines));
    // The numbers of a lamp that stands still begin as ever.
    const Inspection still = inspect(exactScene(sphere(0.5), 9), InspectionRequest(carried.request));
    QVERIFY(describeSelection(still, {7, "limit-angle"}, "limit-angle").front().title.startsWith(QStringLiteral("Highlight")));
  }

  void numbersGiveDigitsAwayBeforeTheyAreCut() {
    QCOMPARE(withDigits(QStringLiteral("-0.0157631  -0.307979  12 m"), 3), QStringLiteral("-0.0158  -0.308  12 m"));
    QCOMPARE(withDigits(QStringLiteral("frame 0003: 1.5e-05"), 1), QStringLiteral("frame 0003: 2e-05"));
    QTreeWidget tree;
    tree.setColumnCount(1);
    tree.setItemDelegate(new NumberDelegate(&tree));
    const QString all = QStringLiteral("-0.0157631  -0.307979  0.218591 m");
    tree.addTopLevelItem(new QTreeWidgetItem({all}));
    struct Delegate : NumberDelegate {
      using NumberDelegate::initStyleOption;
    } delegate;
    QStyleOptionViewItem option;
    option.fontMetrics = tree.fontMetrics();
    const QModelIndex index = tree.model()->index(0, 0);
    option.rect = QRect(0, 0, 1000, 20);
    delegate.initStyleOption(&option, index);
    QCOMPARE(option.text, all);
    option.rect.setWidth(option.fontMetrics.horizontalAdvance(all) - 20);
    delegate.initStyleOption(&option, index);
    QVERIFY2(option.text.size() < all.size() && option.fontMetrics.horizontalAdvance(option.text) <= option.rect.width(),
             qPrintable(option.text));
    QVERIFY2(option.text.endsWith(" m"), "the unit stays");
  }

 private:
  Fixture fixture_;
  std::unique_ptr<Document> document_;
  std::unique_ptr<ParameterPanel> panel_;
};

QObject* makePanelTest() { return new PanelTest; }

}  // namespace glint::gui

#include "panel_test.moc"
