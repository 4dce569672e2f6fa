// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QObject>
#include <QTemporaryDir>
#include <QtTest>
#include <memory>

#include "gui/document/engine.h"

// Qt gives up after 5 s. A busy machine takes longer, and no test needs a certain speed.
#undef QTRY_VERIFY
#define QTRY_VERIFY(expression) QTRY_VERIFY_WITH_TIMEOUT(expression, 60000)
#undef QTRY_COMPARE
#define QTRY_COMPARE(actual, expected) QTRY_COMPARE_WITH_TIMEOUT(actual, expected, 60000)

namespace glint::gui {

/// A scene of small photographs on disk, and an engine whose inspection is a quick stand-in: in every frame one observed circle
/// and, per model, one predicted circle with an error that depends on frame and model.
class Fixture {
 public:
  explicit Fixture(int frames = 12);
  std::shared_ptr<const Scene> scene() const { return scene_; }
  Opened opened() const;
  Engine engine() const;
  static Pixel centre(int frame) { return {60.0 + 4 * frame, 50.25}; }
  static constexpr double kRadius = 20;

 private:
  QTemporaryDir folder_;
  std::shared_ptr<Scene> scene_;
};

/// The stand-in's result.
Inspection drawnCircles(std::shared_ptr<const Scene> scene, const InspectionRequest& request);
/// The same as an answer of an engine's `ask`.
Pipeline::Answer drawn(const Pipeline& pipeline, const Question& question);

/// The program's engine, which opens and computes each file below `folder` ("" = the sessions that ship) once in a process: tests
/// open the same one in every function. Its known results serve as the earlier ones from which the next are computed, so that a
/// changed request is computed as ever.
Engine knownEngine(const QString& folder = {});

/// Presses the left button, moves through the points with it held, and releases it at the last one.
/// (QTest::mouseMove moves the pointer of the display, which holds no button.)
void drag(QWidget* widget, const std::vector<QPoint>& points);

/// Test classes are run by name, so that each is a test of CTest.
using TestFactory = QObject* (*)();
struct TestClass {
  const char* name;
  TestFactory make;
};
QObject* makeAccessibilityTest();
QObject* makeDecodedFramesTest();
QObject* makeDiagnosisTest();
QObject* makeDocumentTest();
QObject* makeRunnerTest();
QObject* makeObserverTest();
QObject* makeFrameCanvasTest();
QObject* makeFrameViewTest();
QObject* makeThemeTest();
QObject* makeTimelineTest();
QObject* makePaletteTest();
QObject* makeStartPageTest();
QObject* makePanelTest();
QObject* makeParametersTest();
QObject* makePickingTest();
QObject* makeRandomTest();
QObject* makeJobsTest();
QObject* makeLinkingTest();
QObject* makeWindowTest();
QObject* makeCanvasTest();
QObject* makeTruthTest();
QObject* makeSessionTest();
QObject* makeProgramTest();
QObject* makeComparisonTest();
QObject* makeExportTest();
QObject* makeFigureTest();
QObject* makeExplainTest();
QObject* makeLessonsTest();
QObject* makeRecoveryTest();
int runUntilKilled();  ///< see recovery_test.cpp
QObject* makeTableTest();
QObject* makeTradeoffTest();
QObject* makeTurnsTest();
QObject* makeUnmatchedTest();
QObject* makeUnreadableTest();
QObject* makeCapturesTest();
QObject* makeInputReportTest();
QObject* makeLampsTest();
QObject* makeBallWindowTest();
QObject* makeRelinkedTest();
QObject* makeRetextureTest();
QObject* makeWhatIfTest();
QObject* makeWindowSizeTest();
QObject* makeCameraPickingTest();
QObject* makePlotsTest();
QObject* makeSceneTest();
QObject* makeNavigationTest();
QObject* makeSceneTreeTest();
QObject* makeSaveTest();
QObject* makeHostileNamesTest();
QObject* makeTypingTest();

}  // namespace glint::gui
