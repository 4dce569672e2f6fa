// SPDX-License-Identifier: BSD-3-Clause
#include "gui/document/document.h"

#include <type_traits>

#include "gui/window/window_title.h"
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
    QCOMPARE(document_->request().train, std::string("0000-0005,0009"));
    document_->setRole(0, FrameRole::HeldOut);
    QCOMPARE(document_->request().train, std::string("0001-0005,0009"));
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

  /// Undo, redo and a setting that is put back lead to results that were there: at once, and never out of date on the way.
  void resultsThatWereThereComeBackWithoutARun() {
    const auto first = showResults();
    document_->setSetting("detect.level", 0.3);
    const auto second = showResults();
    QSignalSpy stale(document_.get(), &Document::staleChanged), shown(document_.get(), &Document::inspectionChanged);
    document_->undoStack()->undo();
    QVERIFY(document_->inspection() == first && document_->computed() == first && !document_->frameStale());
    document_->undoStack()->redo();
    QVERIFY(document_->inspection() == second);
    document_->setSetting("detect.level", 0.5);
    QVERIFY(document_->inspection() == first);
    QCOMPARE(stale.count(), 0);
    QCOMPARE(shown.count(), 3);
    document_->setSetting("detect.level", 0.6);  // that was never there
    QVERIFY(document_->stale());
  }

  void theEndOfAnOvertakenRunTakesNothingAway() {
    const auto first = showResults();
    document_->setSetting("detect.level", 0.3);
    const InspectionRequest overtaken = document_->request();
    document_->undoStack()->undo();
    const auto late = std::make_shared<const Inspection>(drawnCircles(fixture_.scene(), overtaken));
    document_->setFrameInspection(late, 0);
    document_->setInspection(late, overtaken);
    QVERIFY(document_->inspection() == first && document_->results() == first && !document_->stale());
    document_->undoStack()->redo();  // but what it found is there
    QVERIFY(document_->inspection() == late && !document_->stale());
  }

  /// A long drag passes more positions than are kept: the state before it stays.
  void positionsThatASliderPassedGoFirst() {
    const auto first = showResults();
    const int drag = document_->newGesture();
    for (int i = 0; i < 3 * int(Pipeline::kMost); ++i) {
      document_->setSetting("detect.level", 0.3 + 0.01 * i, drag);
      showResults();
    }
    const InspectionRequest end = document_->request();
    document_->setSetting("detect.level", 0.3, document_->newGesture());
    QVERIFY(document_->stale());  // passed long ago
    document_->undoStack()->undo();
    QVERIFY(!document_->stale() && document_->request() == end);
    document_->undoStack()->undo();
    QVERIFY(!document_->stale() && document_->inspection() == first);
  }

  void onlyAFewResultsAreKeptAndNoneOfAnotherScene() {
    showResults();
    for (int i = 0; i < int(Pipeline::kMost); ++i) {
      document_->setSetting("detect.level", 0.3 + 0.01 * i);
      showResults();
    }
    for (int i = 1; i < int(Pipeline::kMost); ++i) document_->undoStack()->undo();
    QVERIFY(!document_->stale());
    document_->undoStack()->undo();
    QVERIFY(document_->stale());
    document_->open(fixture_.opened());
    QVERIFY(document_->stale() && !document_->inspection());
  }

  /// Results come as from a run: the views go back to what is computed, and what is pinned stays.
  void pinnedResultsStayBesideThoseThatComeBack() {
    const auto first = showResults();
    QVERIFY(document_->pin());
    document_->setSetting("detect.level", 0.3);
    showResults();
    document_->showPinned(true);
    document_->undoStack()->undo();
    QVERIFY(!document_->pinnedShown() && document_->pinned() == first && document_->inspection() == first);
    QCOMPARE(document_->rows(), document_->pinnedRows());
  }

  void resultsOfAnotherSceneAreDropped() {
    const Fixture other;
    document_->setInspection(std::make_shared<const Inspection>(drawnCircles(other.scene(), {})), {});
    QVERIFY(!document_->inspection());
  }

  /// Selecting, stepping, layers, plots, the theme of a view: how things are looked at. It is saved along, and asks for nothing.
  void lookingIsNoUnsavedChange() {
    document_->selectFrame(4);
    document_->select({4, "canonical", 0});
    document_->setLayerVisible("rays", "Rays", !document_->layerVisible("rays"));
    document_->setOption("plots/kind", "dial", "Plot");
    document_->setOption("explain/step", "contour", "Explain");
    QVERIFY(!document_->hasUnsavedChanges());
    QVERIFY(!document_->looksAsSaved());
    QVERIFY(document_->toSave().layers.count("rays") && document_->toSave().options.count("plots/kind"));
    while (document_->undoStack()->canUndo()) document_->undoStack()->undo();
    QVERIFY(document_->looksAsSaved());
    QCOMPARE(document_->selection().frame, 0);
    document_->setOption("scene/view/Top", "0 0 3 0 0 0 0 1 0 30 0", "Save Top");  // kept on purpose: that would be lost
    QVERIFY(document_->hasUnsavedChanges());
    document_->undoStack()->undo();
    QVERIFY(!document_->hasUnsavedChanges());
    document_->setSetting("detect.level", 0.4);
    QVERIFY(document_->hasUnsavedChanges());
  }

  void playingLeavesNoStepOfUndo() {
    document_->setSetting("detect.level", 0.4);
    document_->undoStack()->undo();
    for (int frame = 1; frame < 6; ++frame) document_->showFrame(frame);
    document_->showOption("explain/walk-step", 7);
    QCOMPARE(document_->selection().frame, 5);
    QCOMPARE(document_->option("explain/walk-step", 0.0), 7.0);
    QCOMPARE(document_->undoStack()->count(), 1);
    QVERIFY(document_->undoStack()->canRedo());  // what was taken back can still be done again
  }

  void anActionsNameIsItsOwnInTheMenuToo() {
    auto scene = std::make_shared<Scene>(*fixture_.scene());
    scene->frames[1].id = "a&b\nc";
    Opened opened = fixture_.opened();
    opened.scene = scene;
    document_->open(opened);
    document_->selectFrame(1);
    QCOMPARE(document_->undoStack()->text(0), QStringLiteral("Select frame a&b\\nc"));
    QCOMPARE(document_->undoStack()->undoText(), QStringLiteral("Select frame a&&b\\nc"));
  }

  /// "scene.json" tells nothing; the file of a session does where it is called otherwise.
  void aWindowIsCalledAfterItsScene() {
    auto scene = std::make_shared<Scene>(*fixture_.scene());
    scene->name = "vase";
    Opened opened = fixture_.opened();
    opened.scene = scene;
    document_->open(opened);
    QCOMPARE(titleOf(*document_), QStringLiteral("vase"));
    document_->markSaved(QStringLiteral("/some/where/run 2.glint"), document_->state());
    QCOMPARE(titleOf(*document_), QStringLiteral("vase (run 2.glint)"));
    document_->markSaved(QStringLiteral("/some/where/vase.glint"), document_->state());
    QCOMPARE(titleOf(*document_), QStringLiteral("vase"));
    scene->name.clear();
    QCOMPARE(titleOf(*document_), QStringLiteral("vase.glint"));
  }

  /// The history names what was meant, not its coordinates.
  void aSelectionsNameIsWhatWasChosen() {
    draw::Selection s;
    const auto after = [this, &s] {
      document_->select(s);
      return document_->undoStack()->undoText();
    };
    s.model = "limit-angle";
    QCOMPARE(after(), QStringLiteral("Select limit-angle"));
    s.frame = 3;
    QCOMPARE(after(), QStringLiteral("Select frame 0003"));
    s.highlight = 1;
    s.light = "lamp";
    QCOMPARE(after(), QStringLiteral("Select highlight 2 in frame 0003"));
    s.direction = 0.5;  // 28.6 degrees
    QCOMPARE(after(), QStringLiteral("Select contour point at 29° in frame 0003"));
    s.direction.reset();
    QCOMPARE(after(), QStringLiteral("Deselect the contour point"));
    s.highlight = -1;
    QCOMPARE(after(), QStringLiteral("Deselect the highlight"));
    s.light.clear();
    QCOMPARE(after(), QStringLiteral("Select all lights"));
    s.model.clear();
    QCOMPARE(after(), QStringLiteral("Select all models"));
    s.light = "lamp";
    QCOMPARE(after(), QStringLiteral("Select light lamp"));
    s = {5, "dual", 0, "lamp", {}};
    QCOMPARE(after(), QStringLiteral("Select dual, highlight 1 in frame 0005"));
    s = {6, "canonical", -1, "other", {}};
    QCOMPARE(after(), QStringLiteral("Select canonical, light other in frame 0006"));
  }

  void aViewOptionIsOneStepAndAGestureIsOne() {
    document_->setOption("frame/gamma", 1.8, "Gamma 1.8");
    document_->setOption("scene/colour-by", "error", "Cameras by error");
    QCOMPARE(document_->option("frame/gamma", 1.0), 1.8);
    QCOMPARE(document_->option("scene/colour-by", std::string("role")), std::string("error"));
    QCOMPARE(document_->option("frame/no-such", 0.5), 0.5);
    // By value: a reference to a default that the caller made in the call would outlive it.
    static_assert(std::is_same_v<decltype(document_->option("", std::string())), std::string>);
    const int steps = document_->undoStack()->count(), gesture = document_->newGesture();
    for (const double gamma : {1.9, 2.0, 2.1}) document_->setOption("frame/gamma", gamma, "Gamma", gesture);
    QCOMPARE(document_->undoStack()->count(), steps + 1);
    while (document_->undoStack()->canUndo()) document_->undoStack()->undo();
    QCOMPARE(document_->option("frame/gamma", 1.0), 1.0);
  }

  void randomActionsUndoToTheFirstState() {
    const ViewState first = document_->state();
    unsigned seed = 7;
    const auto random = [&seed](int n) { return int((seed = seed * 1664525u + 1013904223u) >> 16) % n; };
    for (int i = 0; i < 200; ++i) {
      switch (random(5)) {
        case 0: document_->setSetting("detect.level", 0.1 + 0.01 * random(50)); break;
        case 1: document_->setRole(random(12), FrameRole(random(3))); break;
        case 2: document_->selectFrame(random(12)); break;
        case 3: document_->setLayerVisible("rays", "Rays", random(2) == 0); break;
        default: document_->setSource(random(2) ? FrameSource::Image : FrameSource::Radiance); break;
      }
    }
    QVERIFY(document_->undoStack()->count() > 100);
    while (document_->undoStack()->canUndo()) document_->undoStack()->undo();
    QVERIFY(document_->request() == first.request);
    QCOMPARE(document_->selection().frame, first.selection.frame);
    QCOMPARE(document_->state().layers, first.layers);
  }

  /// Where ids are numbers themselves, "5" is the frame of that id.
  void trainingFramesKeepTheirMeaningWhereIdsAreNumbers() {
    auto scene = std::make_shared<Scene>(*fixture_.scene());
    for (std::size_t i = 0; i < scene->frames.size(); ++i) scene->frames[i].id = std::to_string(i + 1);
    Opened opened = fixture_.opened();
    opened.scene = scene;
    document_->open(opened);
    document_->setRole(8, FrameRole::Training);
    for (int i = 0; i < 12; ++i) QCOMPARE(document_->role(i), i < 6 || i == 8 ? FrameRole::Training : FrameRole::HeldOut);
  }

 private:
  /// Finished results of what is asked for now.
  std::shared_ptr<const Inspection> showResults() {
    auto results = std::make_shared<const Inspection>(drawnCircles(fixture_.scene(), document_->request()));
    document_->setInspection(results, document_->request());
    return results;
  }
  Fixture fixture_;
  std::unique_ptr<Document> document_;
};

QObject* makeDocumentTest() { return new DocumentTest; }

}  // namespace glint::gui

#include "document_test.moc"
