// SPDX-License-Identifier: BSD-3-Clause
#include "gui/document/document.h"

#include "tests/gui/fixture.h"

namespace glint::gui {

class DocumentTest : public QObject {
  Q_OBJECT
 private slots:
  void init() {
    document_ = std::make_unique<Document>(parseTrainSpec);
    document_->open(fixture_.opened());
  }

  void aSettingIsOneStepThatUndoRestores() {
    document_->setSetting("detect.level", 0.3);
    QCOMPARE(document_->undoStack()->count(), 1);
    QCOMPARE(document_->request().settings.number("detect.level"), 0.3);
    document_->undoStack()->undo();
    QCOMPARE(document_->request().settings.number("detect.level"), 0.5);
    document_->undoStack()->redo();
    QCOMPARE(document_->request().settings.number("detect.level"), 0.3);
  }

  void stepsOfOneGestureMergeAndOthersDoNot() {
    const int drag = document_->newGesture();
    for (const double level : {0.4, 0.35, 0.3}) document_->setSetting("detect.level", level, drag);
    QCOMPARE(document_->undoStack()->count(), 1);
    document_->setSetting("detect.level", 0.2, document_->newGesture());
    QCOMPARE(document_->undoStack()->count(), 2);
    document_->undoStack()->undo();
    QCOMPARE(document_->request().settings.number("detect.level"), 0.3);
    document_->undoStack()->undo();
    QCOMPARE(document_->request().settings.number("detect.level"), 0.5);
  }

  void anActionThatChangesNothingLeavesNoStep() {
    document_->setSetting("detect.level", 0.5);
    document_->selectFrame(0);
    document_->setRole(0, FrameRole::Training);
    QCOMPARE(document_->undoStack()->count(), 0);
    QVERIFY(!document_->hasUnsavedChanges());
  }

  void rolesFollowTrainingAndExclusion() {
    QCOMPARE(int(document_->role(5)), int(FrameRole::Training));  // first:6
    QCOMPARE(int(document_->role(6)), int(FrameRole::HeldOut));
    document_->setRole(2, FrameRole::Excluded);
    QCOMPARE(document_->request().excluded, std::vector<int>{2});
    QCOMPARE(document_->request().train, std::string("first:6"));  // the words stay
    document_->setRole(9, FrameRole::Training);
    QCOMPARE(document_->request().train, std::string("0-5,9"));
    document_->setRole(0, FrameRole::HeldOut);
    QCOMPARE(document_->request().train, std::string("1-5,9"));
    while (document_->undoStack()->canUndo()) document_->undoStack()->undo();
    QVERIFY(document_->request().excluded.empty());
    QCOMPARE(document_->request().train, std::string("first:6"));
    QCOMPARE(int(document_->role(9)), int(FrameRole::HeldOut));
  }

  void aSpecificationThatDoesNotParseIsRefused() {
    QString error;
    QVERIFY(!document_->setTrain("first:many", &error));
    QVERIFY(!error.isEmpty() && !error.contains('\n'));
    QCOMPARE(document_->request().train, std::string("first:6"));
    QCOMPARE(document_->undoStack()->count(), 0);
  }

  void resultsOfAnOlderRequestAreStale() {
    const InspectionRequest older = document_->request();
    const auto results = std::make_shared<const Inspection>(drawnCircles(fixture_.scene(), older));
    QVERIFY(document_->stale());
    document_->setInspection(results, older);
    QVERIFY(!document_->stale());
    document_->setSetting("detect.level", 0.3);
    QVERIFY(document_->stale());
    document_->setInspection(results, older);
    QVERIFY(document_->stale());
  }

  void resultsOfAnotherSceneAreDropped() {
    const Fixture other;
    document_->setInspection(std::make_shared<const Inspection>(drawnCircles(other.scene(), {})), {});
    QVERIFY(!document_->inspection());
  }

  void movingThroughFramesIsNoUnsavedChange() {
    document_->selectFrame(4);
    QVERIFY(!document_->hasUnsavedChanges());
    document_->setLayerVisible("rays", "Rays", !document_->layerVisible("rays"));
    QVERIFY(document_->hasUnsavedChanges());
    document_->undoStack()->undo();
    document_->undoStack()->undo();
    QVERIFY(!document_->hasUnsavedChanges());
    QCOMPARE(document_->selection().frame, 0);
  }

  void aViewOptionIsOneStepAndAGestureIsOne() {
    document_->setOption("frame/gamma", 1.8, "Gamma 1.8");
    document_->setOption("scene/colour-by", "error", "Cameras by error");
    QCOMPARE(document_->option("frame/gamma", 1.0), 1.8);
    QCOMPARE(document_->option("scene/colour-by", std::string("role")), std::string("error"));
    QCOMPARE(document_->option("frame/no-such", 0.5), 0.5);
    QVERIFY(document_->hasUnsavedChanges());
    const int steps = document_->undoStack()->count(), gesture = document_->newGesture();
    for (const double gamma : {1.9, 2.0, 2.1}) document_->setOption("frame/gamma", gamma, "Gamma", gesture);
    QCOMPARE(document_->undoStack()->count(), steps + 1);
    while (document_->undoStack()->canUndo()) document_->undoStack()->undo();
    QCOMPARE(document_->option("frame/gamma", 1.0), 1.0);
    QVERIFY(!document_->hasUnsavedChanges());
  }

  void randomActionsUndoToTheFirstState() {
    const ViewState first = document_->state();
    unsigned seed = 7;
    const auto random = [&seed](int n) { return int((seed = seed * 1664525u + 1013904223u) >> 16) % n; };
    for (int i = 0; i < 200; ++i) {
      switch (random(5)) {
        case 0:
          document_->setSetting("detect.level", 0.1 + 0.01 * random(50));
          break;
        case 1:
          document_->setRole(random(12), FrameRole(random(3)));
          break;
        case 2:
          document_->selectFrame(random(12));
          break;
        case 3:
          document_->setLayerVisible("rays", "Rays", random(2) == 0);
          break;
        default:
          document_->setSource(random(2) ? FrameSource::Image : FrameSource::Radiance);
          break;
      }
    }
    QVERIFY(document_->undoStack()->count() > 100);
    while (document_->undoStack()->canUndo()) document_->undoStack()->undo();
    QVERIFY(document_->request() == first.request);
    QCOMPARE(document_->selection().frame, first.selection.frame);
    QCOMPARE(document_->state().layers, first.layers);
  }

  void framesAsRanges() {
    QCOMPARE(rangesText({}), std::string());
    QCOMPARE(rangesText({3}), std::string("3"));
    QCOMPARE(rangesText({0, 1, 2, 7, 9, 10}), std::string("0-2,7,9-10"));
  }

 private:
  Fixture fixture_;
  std::unique_ptr<Document> document_;
};

QObject* makeDocumentTest() { return new DocumentTest; }

}  // namespace glint::gui

#include "document_test.moc"
