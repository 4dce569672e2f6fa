// SPDX-License-Identifier: BSD-3-Clause
// Missed and spurious highlights by mouse, and highlights changed by hand. An observed contour is moved away from the exact one,
// so that the exact prediction is spurious and the moved contour is missed.
#include <QAction>
#include <QDoubleSpinBox>
#include <QMenu>
#include <QRegularExpression>
#include <QSignalSpy>
#include <QSlider>
#include <QSortFilterProxyModel>
#include <QTableView>
#include <QTreeView>
#include <QTreeWidget>
#include <QTreeWidgetItemIterator>

#include "gui/frame/frame_canvas.h"
#include "gui/frame/frame_panel.h"
#include "gui/frame/highlight_edits.h"
#include "gui/panels/diagnosis_panel.h"
#include "gui/panels/error_model.h"
#include "gui/panels/error_table.h"
#include "gui/panels/selection_text.h"
#include "gui/scene/scene_tree.h"
#include "gui/whatif/what_if_panel.h"
#include "tests/core/pipeline/exact_scene.h"
#include "tests/gui/fixture.h"

namespace glint::gui {

class UnmatchedTest : public QObject {
  Q_OBJECT
 private:
  static constexpr int kFrame = 7;
  static constexpr double kAway = -170;  // px

  void open() {
    using namespace testing_support;
    const std::shared_ptr<Scene> scene = exactScene(sphere(0.5), 9);
    Highlight& h = scene->frames[kFrame].highlights[0];
    exact_ = h.contour;
    for (Pixel& p : h.contour.points) p.x() += kAway;
    h.peak.x() += kAway;
    h.ellipse.reset();
    Opened opened;
    opened.path = "exact.json";
    opened.scene = scene;
    opened.request.models = {"limit-angle"};
    opened.request.train = "0-5";
    opened.selection.frame = kFrame;
    document_->open(opened);
    compute();
  }
  void compute() {
    const InspectionRequest request = document_->request();
    document_->setInspection(std::make_shared<const Inspection>(inspect(document_->sharedScene(), request)), request);
    QTRY_VERIFY(!frame_->busy());
  }
  QString numbers() const {
    QString text;
    for (const NumberGroup& g : describeSelection(*document_->inspection(), document_->selection(), document_->plottedModel()))
      text += g.title + QLatin1Char('\n') + g.lines + QLatin1Char('\n');
    return text;
  }
  QPoint at(const Pixel& p) const { return frame_->canvas()->widgetFromPixel(p).toPoint(); }
  void click(const Pixel& p) { QTest::mouseClick(frame_->canvas(), Qt::LeftButton, {}, at(p)); }
  void point(const Pixel& p) {
    QMouseEvent move(QEvent::MouseMove, at(p), frame_->canvas()->mapToGlobal(at(p)), Qt::NoButton, Qt::NoButton, Qt::NoModifier);
    QApplication::sendEvent(frame_->canvas(), &move);
  }

 private slots:
  void init() {
    document_ = std::make_unique<Document>(parseTrainSpec);
    frame_ = std::make_unique<FramePanel>(*document_);
    actions_ = std::make_unique<Actions>();
    menu_ = std::make_unique<QMenu>();
    frame_->addActions(*actions_, menu_.get());
    frame_->resize(900, 800);
    frame_->show();
    QVERIFY(QTest::qWaitForWindowExposed(frame_.get()));
    open();
    QImage grey(640, 480, QImage::Format_RGB32);
    grey.fill(Qt::darkGray);
    frame_->canvas()->setPhotograph(grey);
  }
  void cleanup() {
    menu_.reset();
    frame_.reset();
    actions_.reset();
    document_.reset();
  }

  void aClickSelectsWhatIsSpuriousAndSaysWhy() {
    click(exact_.points[10]);
    const draw::Selection s = document_->selection();
    QCOMPARE(s.model, std::string("limit-angle"));
    QCOMPARE(s.light, std::string("lamp"));
    QCOMPARE(s.highlight, -1);
    QCOMPARE(s.predicted, 0);
    QVERIFY2(numbers().contains(QStringLiteral("spurious, predicted by limit-angle: the nearest observed highlight is")),
             qPrintable(numbers()));
    // The key F goes there.
    frame_->goToHighlight();
    QVERIFY((frame_->canvas()->centre() - centroid(exact_)).norm() < 3);
    // The selection belongs to this frame: another frame has nothing selected, and undo brings it back.
    document_->selectFrame(3);
    QCOMPARE(document_->selection().predicted, -1);
    document_->undoStack()->undo();
    QCOMPARE(document_->selection().predicted, 0);
  }

  void aClickSelectsWhatIsMissed() {
    click(exact_.points[10]);  // the model
    click(exact_.points[10] + Pixel(kAway, 0));
    QCOMPARE(document_->selection().highlight, 0);
    QCOMPARE(document_->selection().predicted, -1);
    QVERIFY2(numbers().contains(QStringLiteral("missed by limit-angle: the nearest predicted highlight is")),
             qPrintable(numbers()));
  }

  void aRowSelectsTheSame() {
    ErrorTable table(*document_);
    table.resize(900, 400);
    table.show();
    QVERIFY(QTest::qWaitForWindowExposed(&table));
    int seen = 0;
    for (int row = 0; row < table.view()->model()->rowCount(); ++row) {
      const QString status = table.view()->model()->index(row, ErrorModel::Status).data().toString();
      if (status == QStringLiteral("ok")) continue;
      table.view()->setCurrentIndex(table.view()->model()->index(row, 0));
      QCOMPARE(document_->selection().frame, kFrame);
      QCOMPARE(document_->selection().highlight, status == QStringLiteral("missed") ? 0 : -1);
      QCOMPARE(document_->selection().predicted, status == QStringLiteral("spurious") ? 0 : -1);
      ++seen;
    }
    QCOMPARE(seen, 2);
  }

  void aLineOfProblemsSelectsTheSame() {
    DiagnosisPanel panel(*document_);
    panel.resize(700, 400);
    panel.show();
    QVERIFY(QTest::qWaitForWindowExposed(&panel));
    int spurious = 0;
    for (QTreeWidgetItemIterator it(panel.list()); *it; ++it) {
      if (!(*it)->text(0).contains(QStringLiteral("predicted highlight 1 spurious"))) continue;
      ++spurious;
      panel.list()->expandAll();
      panel.list()->scrollToItem(*it);
      QTest::mouseClick(panel.list()->viewport(), Qt::LeftButton, {}, panel.list()->visualItemRect(*it).center());
      QCOMPARE(document_->selection().predicted, 0);
      QCOMPARE(document_->selection().frame, kFrame);
      break;
    }
    QCOMPARE(spurious, 1);
  }

  void theTreeListsBothAndSelectsTheSame() {
    SceneTree tree(*document_);
    tree.resize(300, 600);
    tree.show();
    QVERIFY(QTest::qWaitForWindowExposed(&tree));
    const QModelIndex camera = tree.model().indexOf({SceneObject::Kind::Camera, kFrame, -1, {}, {}});
    QCOMPARE(tree.model().rowCount(camera), 2);
    QCOMPARE(tree.model().rowCount(tree.model().indexOf({SceneObject::Kind::Camera, kFrame - 1, -1, {}, {}})), 1);
    const QModelIndex missed = tree.model().index(0, 0, camera), spurious = tree.model().index(1, 0, camera);
    QCOMPARE(missed.data().toString(), QStringLiteral("□ missed 1, by limit-angle"));
    QCOMPARE(spurious.data().toString(), QStringLiteral("△ spurious 1, of limit-angle"));
    QVERIFY(missed.data(Qt::ToolTipRole).toString().contains(QStringLiteral("the nearest predicted highlight is")));
    QVERIFY(spurious.data(Qt::ToolTipRole).toString().contains(QStringLiteral("the nearest observed highlight is")));
    const auto* shown = qobject_cast<const QSortFilterProxyModel*>(tree.view()->model());
    tree.view()->expand(shown->mapFromSource(camera));
    const auto clickRow = [&](const QModelIndex& row) {
      tree.view()->scrollTo(shown->mapFromSource(row));
      QTest::mouseClick(tree.view()->viewport(), Qt::LeftButton, {}, tree.view()->visualRect(shown->mapFromSource(row)).center());
    };
    clickRow(spurious);
    QCOMPARE(document_->selection().predicted, 0);
    QCOMPARE(document_->selection().highlight, -1);
    QCOMPARE(document_->selection().model, std::string("limit-angle"));
    QCOMPARE(document_->undoStack()->undoText(),
             QStringLiteral("Select limit-angle, light lamp, spurious highlight 1 in frame v7"));
    clickRow(missed);
    QCOMPARE(document_->selection().predicted, -1);
    QCOMPARE(document_->selection().highlight, 0);
    // And back: what the photograph selects is marked.
    const auto marked = [&] { return tree.selected().empty() ? SceneObject{} : tree.selected().front(); };
    click(exact_.points[10]);
    QCOMPARE(marked().predicted, 0);
    document_->selectFrame(3);
    QCOMPARE(marked().kind, SceneObject::Kind::Camera);
    document_->undoStack()->undo();
    QCOMPARE(marked().predicted, 0);
    // Where nothing is wrong any more, nothing is listed.
    point(centroid(exact_) + Pixel(kAway, 0));
    actions_->find("frame.ignore-highlight")->trigger();
    compute();
    QCOMPARE(tree.model().rowCount(camera), 1);  // the prediction beside it, where nothing is ignored
  }

  /// The edit is one step of undo; after it nothing of the frame is wrong.
  void ignoringUnderThePointer() {
    const int steps = document_->undoStack()->index();
    point(centroid(exact_) + Pixel(kAway, 0));
    actions_->find("frame.ignore-highlight")->trigger();
    QCOMPARE(document_->undoStack()->index(), steps + 1);
    compute();
    QCOMPARE(int(document_->inspection()->evidence[kFrame].highlights.size()), 0);
    QCOMPARE(int(document_->inspection()->evidence[kFrame].ignored.size()), 1);
    // A second click: it counts again.
    actions_->find("frame.ignore-highlight")->trigger();
    QVERIFY(document_->request().whatIf.none());
    document_->undoStack()->undo();
    document_->undoStack()->undo();
    QCOMPARE(document_->undoStack()->index(), steps);
    QVERIFY(document_->request().whatIf.none());
  }

  void splittingUnderThePointerAndBack() {
    point(centroid(exact_) + Pixel(kAway, 0));
    actions_->find("frame.split-highlight")->trigger();
    compute();
    QCOMPARE(int(document_->inspection()->evidence[kFrame].highlights.size()), 2);
    // Merged again: the hull of both.
    actions_->find("frame.merge-highlights")->trigger();
    compute();
    QCOMPARE(int(document_->inspection()->evidence[kFrame].highlights.size()), 1);
    const double area = document_->inspection()->evidence[kFrame].highlights[0].areaPx2;
    QVERIFY(std::abs(area / std::abs(signedArea(exact_)) - 1) < 0.01);  // it is convex
    QVERIFY2(numbers().contains(QStringLiteral("merged by hand")), qPrintable(numbers()));
    actions_->find("frame.highlights-as-found")->trigger();
    QVERIFY(document_->request().whatIf.none());
  }

  /// An entry that cannot work now is grey and says why; the action itself stays, for the palette and scripts.
  void theMenuOffersWhatCanBeDone() {
    QMenu menu;
    frame_->edits()->offerIn(&menu);
    const auto open = [&](const Pixel& at) {
      point(at);
      menu.popup(frame_->mapToGlobal(QPoint(0, 0)));
      QStringList can;
      for (const char* id :
           {"ignore-highlight", "merge-highlights", "split-highlight", "grow-highlight", "highlights-as-found"}) {
        const QAction* action = actions_->find(QLatin1String("frame.") + QLatin1String(id));
        if (action->isEnabled()) can << QLatin1String(id);
      }
      return can;
    };
    const Pixel inside = centroid(exact_) + Pixel(kAway, 0);
    QCOMPARE(open(inside), (QStringList{"ignore-highlight", "split-highlight", "grow-highlight"}));
    const QAction* merge = actions_->find("frame.merge-highlights");
    QVERIFY2(merge->toolTip().startsWith("This frame shows no other highlight"), qPrintable(merge->toolTip()));
    QVERIFY(actions_->find("frame.highlights-as-found")->toolTip().startsWith("No highlight of this frame was changed"));
    menu.close();
    QVERIFY(merge->isEnabled() && !merge->toolTip().startsWith("This frame"));
    QCOMPARE(open({5, 5}), QStringList{"grow-highlight"});
    menu.close();
    point(inside);
    actions_->find("frame.split-highlight")->trigger();
    compute();
    QCOMPARE(open(inside + Pixel(3, 3)).size(), 5);
    menu.close();
  }

  /// Before and after edits by hand there is a slider for each, and its heading says which is which.
  void whatWasMadeByHandHasSliders() {
    WhatIfPanel panel(*document_);
    panel.resize(400, 600);
    panel.show();
    const auto sliders = [&] { return panel.findChildren<QSlider*>(QRegularExpression("^slider:highlight\\..*scale$")).size(); };
    QTRY_COMPARE(sliders(), 1);
    point(centroid(exact_) + Pixel(kAway, 0));
    actions_->find("frame.split-highlight")->trigger();
    compute();
    QTRY_COMPARE(sliders(), 2);
    QCOMPARE(highlightsToMove(*document_), (QStringList{"split by hand", "split by hand"}));
    const double area = document_->inspection()->evidence[kFrame].highlights[1].areaPx2;
    auto* box = panel.findChild<QDoubleSpinBox*>(QStringLiteral("value:highlight.1.scale"));
    QVERIFY(box);
    box->setValue(1.5);
    compute();
    QVERIFY(std::abs(document_->inspection()->evidence[kFrame].highlights[1].areaPx2 / area - 2.25) < 1e-6);
    document_->undoStack()->undo();
    compute();
    actions_->find("frame.merge-highlights")->trigger();
    compute();
    QStringList after = highlightsToMove(*document_);  // which part keeps its number is where the pointer is
    after.sort();
    QCOMPARE(after, (QStringList{"merged by hand", "not there now"}));
  }

  void whatCannotBeDoneSaysSo() {
    QSignalSpy problems(frame_.get(), &FramePanel::problem);
    point({5, 5});
    for (const char* id :
         {"frame.ignore-highlight", "frame.merge-highlights", "frame.split-highlight", "frame.highlights-as-found"})
      actions_->find(id)->trigger();
    QCOMPARE(problems.count(), 4);
    actions_->find("frame.grow-highlight")->trigger();  // the frame has no photograph
    QTRY_COMPARE(problems.count(), 5);
    QVERIFY(document_->request().whatIf.none());
  }

 private:
  std::unique_ptr<Document> document_;
  std::unique_ptr<FramePanel> frame_;
  std::unique_ptr<Actions> actions_;
  std::unique_ptr<QMenu> menu_;
  Polyline exact_;
};

QObject* makeUnmatchedTest() { return new UnmatchedTest; }

}  // namespace glint::gui

#include "unmatched_test.moc"
