// SPDX-License-Identifier: BSD-3-Clause
// Whatever is done, in any order, undoing all of it gives back the first session and the first results, bit for bit, and redoing
// all of it the last ones.
#include <QAction>
#include <QCheckBox>
#include <QComboBox>
#include <QDockWidget>
#include <QListWidget>
#include <QSlider>
#include <QTemporaryDir>
#include <QToolButton>
#include <QTreeView>
#include <algorithm>
#include <filesystem>
#include <map>
#include <random>

#include "core/app/session.h"
#include "core/draw/frame_overlay.h"
#include "gui/base/text.h"
#include "gui/panels/parameter_panel.h"
#include "gui/timeline/timeline.h"
#include "gui/whatif/what_if_panel.h"
#include "gui/window/main_window.h"
#include "tests/gui/fixture.h"
#include "tests/sanitizers/cases.h"

namespace glint::gui {

namespace {
constexpr int kSteps = 50, kMostSteps = 200;

/// Actions that are left out, by the beginning of their ids, and why.
const std::map<QString, const char*>& leftOut() {
  static const std::map<QString, const char*> ids{{"file.", "ask for a file, or close what is open"},
                                                  {"export.", "ask for a file, or change the clipboard only"},
                                                  {"edit.palette", "takes the keyboard"},
                                                  {"edit.search-errors", "takes the keyboard"},
                                                  {"edit.error-columns", "opens a menu that waits for the user"},
                                                  {"edit.shortcuts", "opens a dialog that waits for the user"},
                                                  {"help.", "open a page or a dialog"},
                                                  {"view.pin", "keeps results beside the history of undo, and shows them"},
                                                  {"view.present", "changes the screen and the fonts"},
                                                  {"plots.save", "asks for a file"},
                                                  {"lamps.save", "asks for a file"},
                                                  {"lamps.balls", "asks for a folder"},
                                                  {"lamps.measure", "goes on in the background"},
                                                  {"frame.retexture-choose-", "asks for a file"},
                                                  {"frame.play", "goes on by the clock"},
                                                  {"explain.play-walk", "goes on by the clock"},
                                                  {"explain.duality", "opens a window"},
                                                  {"lesson.", "opens another session"},
                                                  {"edit.stop", "leaves results out of date"},
                                                  {"plots.influence", "fits once per training frame"},
                                                  {"frame.grow-highlight", "goes on in the background"},
                                                  {"plots.diagnose", "goes on in the background"}};
  return ids;
}
bool isLeftOut(const QString& id) {
  for (const auto& [start, reason] : leftOut())
    if (id.startsWith(start)) return true;
  return false;
}
}  // namespace

class RandomTest : public QObject {
  Q_OBJECT
 private slots:
  void undoneToTheFirstStateAndRedoneToTheLast_data() {
    QTest::addColumn<QString>("name");
    QTest::addColumn<unsigned>("seed");
    QTest::newRow("plane, seed 1") << QStringLiteral("plane") << 1u;
    QTest::newRow("plane, seed 3") << QStringLiteral("plane") << 3u;
    QTest::newRow("two lamps, seed 1") << QStringLiteral("two-lamps") << 1u;  // lights to be switched as well
  }
  void undoneToTheFirstStateAndRedoneToTheLast() {
    QFETCH(QString, name);
    QFETCH(unsigned, seed);
    MainWindow window(coreEngine());
    window.resize(1500, 950);
    window.show();
    QVERIFY(QTest::qWaitForWindowExposed(&window));
    // Files that are written beside a session must not lie in the sources.
    const std::filesystem::path copy = copy_.path().toStdString();
    std::filesystem::copy(std::string(GLINT_SOURCE_DIR "/sessions/") + name.toStdString(), copy,
                          std::filesystem::copy_options::recursive | std::filesystem::copy_options::overwrite_existing);
    window.open(copy_.filePath(name + QStringLiteral(".glint")));
    QTRY_VERIFY_WITH_TIMEOUT(window.document().scene() && window.idle() && !window.document().stale(),
                             3 * testing_support::kWaitMs);
    const QList<QAction*> actions = window.actions().all();
    for (const auto& [start, reason] : leftOut())
      QVERIFY2(std::any_of(actions.begin(), actions.end(),
                           [&start = start](const QAction* a) { return Actions::id(a).startsWith(start); }),
               qPrintable(start));
    Document& document = window.document();
    const QByteArray firstSession = session(document);
    const std::string firstResults = results(window);

    std::mt19937 random(seed);
    std::map<QString, int> done;  // steps of undo by the kind of what was done
    const auto allDone = [&] {
      for (const char* kind : {"action", "parameter", "timeline", "layer", "what-if"})
        if (done[QLatin1String(kind)] == 0) return false;
      return window.findChild<TimelineStrip*>()->lights().empty() || done[QStringLiteral("light")] > 0;
    };
    // Goes on until each kind changed something: the choice in a turn depends on the number of actions and layers.
    for (int i = 0; i < kSteps || (i < kMostSteps && !allDone()); ++i) {
      const int before = document.undoStack()->index();
      const QString kind = act(window, random);
      QCoreApplication::processEvents();
      if (QTest::currentTestFailed()) return;
      if (document.undoStack()->index() != before) ++done[kind];
    }
    QVERIFY(allDone());
    const QByteArray lastSession = session(document);
    QVERIFY(lastSession != firstSession);
    const std::string lastResults = results(window);
    QVERIFY(lastResults != firstResults);

    const int steps = document.undoStack()->count();
    for (int i = 0; i < steps; ++i) QVERIFY2(!document.undoStack()->text(i).trimmed().isEmpty(), qPrintable(QString::number(i)));
    QAction* undo = window.actions().find("edit.undo");
    QAction* redo = window.actions().find("edit.redo");
    QVERIFY(undo && redo);
    while (document.undoStack()->canRedo()) redo->trigger();
    const QByteArray furthest = session(document);
    while (undo->isEnabled()) undo->trigger();
    QCOMPARE(document.undoStack()->index(), 0);
    QCOMPARE(session(document), firstSession);
    QCOMPARE(results(window), firstResults);
    while (redo->isEnabled()) redo->trigger();
    QCOMPARE(document.undoStack()->index(), steps);
    QCOMPARE(session(document), furthest);
    if (furthest == lastSession) QCOMPARE(results(window), lastResults);
  }

 private:
  static int below(std::mt19937& random, int n) { return int(random() % unsigned(n)); }

  static QString act(MainWindow& window, std::mt19937& random) {
    switch (below(random, 6)) {
      case 0:
      case 1: {
        QList<QAction*> usable;
        for (QAction* action : window.actions().all())
          if (action->isEnabled() && !isLeftOut(Actions::id(action))) usable << action;
        usable[below(random, usable.size())]->trigger();
        return QStringLiteral("action");
      }
      case 2: {
        const ParamSpec& spec = allParams()[std::size_t(below(random, int(allParams().size())))];
        turn(window.findChild<ParameterPanel*>(), spec, random);
        return QStringLiteral("parameter");
      }
      case 3: {
        TimelineStrip* strip = window.findChild<TimelineStrip*>();
        const int frame = below(random, window.document().frameCount());
        const int where = below(random, strip->lights().empty() ? 2 : 3);
        const QRectF at = where == 0 ? strip->roleMark(frame) : where == 1 ? strip->cell(frame) : strip->lightMark(0, frame);
        if (strip->isVisible()) QTest::mouseClick(strip, Qt::LeftButton, {}, at.center().toPoint());
        return where == 2 ? QStringLiteral("light") : QStringLiteral("timeline");
      }
      case 4: {
        const int what = below(random, 3);
        if (what == 2) {  // a tick of the scene tree
          QAbstractItemModel* tree = window.findChild<QTreeView*>(QStringLiteral("sceneTree"))->model();
          const QModelIndex group = tree->index(below(random, tree->rowCount()), 0);
          if (tree->rowCount(group) == 0) return QStringLiteral("object");
          const QModelIndex object = tree->index(below(random, tree->rowCount(group)), 0, group);
          const bool shown = object.data(Qt::CheckStateRole).toInt() == Qt::Checked;
          tree->setData(object, shown ? Qt::Unchecked : Qt::Checked, Qt::CheckStateRole);
          return QStringLiteral("object");
        }
        if (what == 0) {
          auto* list = window.findChild<QListWidget*>(QStringLiteral("layers"));
          QListWidgetItem* item = list->item(below(random, list->count()));
          item->setCheckState(item->checkState() == Qt::Checked ? Qt::Unchecked : Qt::Checked);
        } else {
          const draw::OverlayLayer& layer = draw::overlayLayers()[std::size_t(below(random, int(draw::overlayLayers().size())))];
          if (auto* toggle = window.findChild<QToolButton*>(QLatin1String(layer.name))) toggle->click();
        }
        return QStringLiteral("layer");
      }
      default: {
        auto* panel = window.findChild<WhatIfPanel*>();
        const QList<QSlider*> sliders = panel->findChildren<QSlider*>();
        if (sliders.isEmpty()) return QStringLiteral("what-if");
        QSlider* slider = sliders[below(random, sliders.size())];
        if (slider->isEnabled())
          slider->setValue(slider->value() + (slider->maximum() - slider->minimum()) / 50 * (1 - 2 * below(random, 2)));
        return QStringLiteral("what-if");
      }
    }
  }

  static void turn(ParameterPanel* panel, const ParamSpec& spec, std::mt19937& random) {
    auto* value = panel->findChild<QWidget*>("value:" + toQString(spec.key));
    if (auto* check = qobject_cast<QCheckBox*>(value)) return check->click();
    if (auto* combo = qobject_cast<QComboBox*>(value)) {
      combo->setCurrentIndex(below(random, combo->count()));
      emit combo->activated(combo->currentIndex());
      return;
    }
    auto* slider = panel->findChild<QSlider*>("slider:" + toQString(spec.key));
    QVERIFY(slider);
    // Near where it is: the ends of some ranges cost minutes.
    slider->setValue(slider->value() + 20 + below(random, 100));
  }

  /// What a session would store, but for results.
  QByteArray session(const Document& document) {
    const QString file = folder_.filePath(QStringLiteral("state.glint"));
    coreEngine().autosave(document.toSave(), file.toStdString());
    QFile text(file);
    return text.open(QIODevice::ReadOnly) ? text.readAll() : QByteArray();
  }
  static std::string results(MainWindow& window) {
    [&] { QTRY_VERIFY_WITH_TIMEOUT(window.idle() && !window.document().stale(), 3 * testing_support::kWaitMs); }();
    return window.document().inspection() ? digestOf(*window.document().inspection()) : std::string();
  }
  QTemporaryDir folder_, copy_;
};

QObject* makeRandomTest() { return new RandomTest; }

}  // namespace glint::gui

#include "random_test.moc"
