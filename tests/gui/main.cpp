// SPDX-License-Identifier: BSD-3-Clause
// test_gui CLASS: runs one class of tests with real widgets. Needs a display: CTest starts a virtual one.
#include <QApplication>
#include <QSettings>
#include <QTemporaryDir>
#include <cstdio>
#include <cstring>
#include <memory>

#include "gui/base/input_rules.h"
#include "gui/base/memory_rules.h"
#include "gui/base/theme.h"
#include "tests/gui/fixture.h"

int main(int argc, char** argv) {
  using namespace glint::gui;
  applyMemoryRules();
  static const TestClass classes[] = {
      {"document", makeDocumentTest},
      {"runner", makeRunnerTest},
      {"observer", makeObserverTest},
      {"accessibility", makeAccessibilityTest},
      {"frame_canvas", makeFrameCanvasTest},
      {"frame_view", makeFrameViewTest},
      {"theme", makeThemeTest},
      {"timeline", makeTimelineTest},
      {"panel", makePanelTest},
      {"palette", makePaletteTest},
      {"start_page", makeStartPageTest},
      {"linking", makeLinkingTest},
      {"window", makeWindowTest},
      {"scene", makeSceneTest},
      {"navigation", makeNavigationTest},
      {"scene_tree", makeSceneTreeTest},
      {"session", makeSessionTest},
      {"program", makeProgramTest},
      {"recovery", makeRecoveryTest},
      {"explain", makeExplainTest},
      {"lessons", makeLessonsTest},
      {"export", makeExportTest},
      {"plots", makePlotsTest},
      {"diagnosis", makeDiagnosisTest},
      {"table", makeTableTest},
      {"tradeoff", makeTradeoffTest},
      {"parameters", makeParametersTest},
      {"picking", makePickingTest},
      {"random", makeRandomTest},
      {"figure", makeFigureTest},
      {"comparison", makeComparisonTest},
      {"unmatched", makeUnmatchedTest},
      {"unreadable", makeUnreadableTest},
      {"captures", makeCapturesTest},
      {"input_report", makeInputReportTest},
      {"lamps", makeLampsTest},
      {"ball_window", makeBallWindowTest},
      {"relinked", makeRelinkedTest},
      {"retexture", makeRetextureTest},
      {"what_if", makeWhatIfTest},
      {"turns", makeTurnsTest},
      {"window_size", makeWindowSizeTest},
      {"camera_picking", makeCameraPickingTest},
      {"truth", makeTruthTest},
      {"canvas", makeCanvasTest},
      {"save", makeSaveTest},
      {"hostile_names", makeHostileNamesTest},
      {"typing", makeTypingTest},
      {"jobs", makeJobsTest},
      {"decoded_frames", makeDecodedFramesTest},
  };
  if (argc < 2) return std::fputs("usage: test_gui CLASS [QTest options]\n", stderr), 2;
  const bool untilKilled = std::strcmp(argv[1], "--until-killed") == 0;
  QTemporaryDir settings;  // recent files and autosaves of whoever runs the tests stay untouched
  if (!untilKilled) qputenv("XDG_DATA_HOME", settings.path().toUtf8());  // the killed child shares it
  QApplication app(argc, argv);
  QSettings::setPath(QSettings::NativeFormat, QSettings::UserScope, settings.path());
  QApplication::setOrganizationName(QStringLiteral("GlintTest"));
  QApplication::setApplicationName(QStringLiteral("test_gui"));
  installInputRules(app);
  applyTheme(app, Theme::Dark);
  if (untilKilled) return runUntilKilled();
  for (const TestClass& c : classes) {
    if (std::strcmp(c.name, argv[1]) != 0) continue;
    const std::unique_ptr<QObject> test(c.make());
    return QTest::qExec(test.get(), argc - 1, argv + 1);
  }
  std::fprintf(stderr, "test_gui: no class '%s'\n", argv[1]);
  return 2;
}
