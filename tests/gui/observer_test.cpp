// SPDX-License-Identifier: BSD-3-Clause
#include "gui/document/observer.h"

#include <QSignalSpy>
#include <atomic>
#include <stdexcept>

#include "tests/gui/fixture.h"

namespace glint::gui {

/// The contour of the frame on screen follows a request before there are results for it.
class ObserverTest : public QObject {
  Q_OBJECT
 private slots:
  void init() {
    asked_ = 0;
    engine_ = fixture_.engine();
    engine_.contour = [this](const Pipeline& pipeline, const InspectionRequest& request, int frame, const ProgressFn&,
                             const Inspection*) -> std::optional<Observation> {
      const std::shared_ptr<const Scene>& scene = pipeline.scene();
      ++asked_;
      if (request.settings.number("detect.level") == kFails) throw std::runtime_error("this level cannot be observed");
      Observation seen;
      seen.scene = seen.given = scene;
      seen.request = request;
      seen.frame = frame;
      seen.evidence = drawnCircles(scene, request).evidence[std::size_t(frame)];
      seen.inputs = inputsOf(request);
      if (seen.inputs.same(Stage::Evidence, inputsOf({}))) return std::nullopt;  // the results hold it
      return seen;
    };
    document_ = std::make_unique<Document>(parseTrainSpec);
    observer_ = std::make_unique<Observer>(engine_, *document_);
    document_->open(fixture_.opened());
  }
  void cleanup() {
    observer_.reset();
    document_.reset();
  }

  void theContourComesBeforeTheModels() {
    showResults();
    QSignalSpy changed(document_.get(), &Document::frameInspectionChanged);
    document_->setSetting("detect.level", 0.3);
    QTRY_COMPARE(changed.count(), 1);
    QCOMPARE(level(), 0.3);
    QCOMPARE(document_->results()->request.settings.number("detect.level"), 0.5);
    QVERIFY(document_->frameStale());
    const ModelResult& model = document_->frameInspection()->models.begin()->second;
    QCOMPARE(model.frames.size(), std::size_t(1));
    QCOMPARE(model.frames[0].frame, 0);
    QVERIFY(model.frames[0].rows.empty());  // an old prediction has no error against a new contour
  }

  void resultsOfAnEarlierPositionDoNotPutTheContourBack() {
    showResults();
    document_->setSetting("detect.level", 0.4);
    const auto late = resultsFor(document_->request());
    document_->setSetting("detect.level", 0.3);
    QTRY_COMPARE(level(), 0.3);
    document_->setFrameInspection(late, 0);
    QCOMPARE(level(), 0.3);
    QCOMPARE(document_->results()->request.settings.number("detect.level"), 0.4);  // but what they predict is shown
    document_->setInspection(late, late->request);
    QCOMPARE(level(), 0.3);
  }

  void resultsThatSawTheSameOrAreAskedForTakeItsPlace() {
    showResults();
    document_->setSetting("detect.level", 0.3);
    const InspectionRequest observed = document_->request();
    QTRY_COMPARE(level(), 0.3);
    document_->setSetting("light.robust_px", 3.0);
    document_->setFrameInspection(resultsFor(observed), 0);
    QCOMPARE(document_->frameInspection(), document_->results());  // its evidence is that of the observation
    document_->setSetting("detect.level", 0.25);
    QTRY_COMPARE(level(), 0.25);
    document_->setInspection(resultsFor(document_->request()), document_->request());
    QCOMPARE(document_->frameInspection(), document_->results());
    QVERIFY(!document_->frameStale());
  }

  /// The same holds where the observation is older, because nothing could be observed under the newest request.
  void resultsThatAreAskedForWinOverAnOlderObservation() {
    showResults();
    document_->setSetting("detect.level", 0.3);
    QTRY_COMPARE(level(), 0.3);
    document_->setSetting("detect.level", kFails);
    QTRY_VERIFY(!observer_->busy());
    QCOMPARE(level(), 0.3);
    document_->setInspection(resultsFor(document_->request()), document_->request());
    QCOMPARE(document_->frameInspection(), document_->results());
  }

  void anObservationThatNobodyAsksForIsIgnored() {
    showResults();
    document_->setSetting("detect.level", kFails);
    QTRY_VERIFY(!observer_->busy());
    Observation other;
    other.scene = other.given = document_->sharedScene();
    other.frame = 0;
    other.request = document_->results()->request;
    other.request.settings.set("detect.level", 0.3);
    other.evidence = document_->results()->evidence[0];
    other.inputs = inputsOf(other.request);
    document_->setObservation(std::make_shared<const Observation>(other));
    QCOMPARE(document_->frameInspection(), document_->results());
  }

  void undoToWhatIsKnownShowsItAgain() {
    showResults();
    document_->setSetting("detect.level", 0.3);
    QTRY_COMPARE(level(), 0.3);
    document_->undoStack()->undo();
    QTRY_COMPARE(level(), 0.5);
    QCOMPARE(document_->frameInspection(), document_->results());
  }

  void anotherFrameOrSceneForgetsIt() {
    showResults();
    document_->setSetting("detect.level", 0.3);
    QTRY_COMPARE(level(), 0.3);
    document_->selectFrame(3);
    QCOMPARE(document_->frameInspection(), document_->results());
    document_->setSetting("detect.level", 0.2);
    document_->selectFrame(4);  // before it is there
    QTRY_VERIFY(!observer_->busy());
    QCOMPARE(document_->frameInspection(), document_->results());
    document_->open(fixture_.opened());
    QVERIFY(!document_->frameInspection());
  }

  void nothingIsObservedBeforeThereAreResults() {
    document_->setSetting("detect.level", 0.3);
    QTRY_VERIFY(!observer_->busy());
    QCOMPARE(asked_.load(), 0);
  }

 private:
  static StageInputs inputsOf(const InspectionRequest& request) {
    StageInputs inputs;
    inputs.evidence = evidenceInputs(request, false);
    return inputs;
  }
  static std::shared_ptr<const Inspection> resultsOf(std::shared_ptr<const Scene> scene, const InspectionRequest& request) {
    Inspection results = drawnCircles(std::move(scene), request);
    results.inputs = inputsOf(request);
    return std::make_shared<const Inspection>(std::move(results));
  }
  std::shared_ptr<const Inspection> resultsFor(const InspectionRequest& request) const {
    return resultsOf(document_->sharedScene(), request);
  }
  void showResults() { document_->setInspection(resultsFor(document_->request()), document_->request()); }
  /// Level of the contour that is shown.
  double level() const { return document_->frameInspection()->evidence[0].highlights.at(0).level; }

  static constexpr double kFails = 0.15;
  Fixture fixture_;
  Engine engine_;
  std::unique_ptr<Document> document_;
  std::unique_ptr<Observer> observer_;
  std::atomic<int> asked_{0};
};

QObject* makeObserverTest() { return new ObserverTest; }

}  // namespace glint::gui

#include "observer_test.moc"
