// SPDX-License-Identifier: BSD-3-Clause
#include "gui/window/palette.h"

#include <QKeySequenceEdit>
#include <QLineEdit>
#include <QMenu>
#include <QMenuBar>
#include <QMessageBox>
#include <QPushButton>
#include <QRegularExpression>
#include <QSet>
#include <QTimer>
#include <QTreeWidget>
#include <algorithm>
#include <cmath>

#include "core/base/numeric.h"
#include "gui/base/text.h"
#include "gui/whatif/what_if_panel.h"
#include "gui/window/main_window.h"
#include "gui/window/palette_items.h"
#include "gui/window/shortcut_dialog.h"
#include "tests/gui/fixture.h"
#include "viz/scene_view.h"

namespace glint::gui {

namespace {
void collect(const QMenu* menu, QSet<QAction*>& found) {
  for (QAction* action : menu->actions())
    if (action->menu())
      collect(action->menu(), found);
    else
      found.insert(action);
}
}  // namespace

class PaletteTest : public QObject {
  Q_OBJECT
 private slots:
  void init() {
    window_ = std::make_unique<MainWindow>(fixture_.engine());
    window_->show();
    QVERIFY(QTest::qWaitForWindowExposed(window_.get()));
    window_->open(toQString(fixture_.opened().path));
    QTRY_VERIFY(window_->document().scene() && window_->idle() && window_->document().inspection());
  }
  void cleanup() { window_.reset(); }

  void wholeWordsCountBeforeStartsInsidesAndLetters() {
    const auto match = [](const char* typed, const char* title) { return matchOf(QLatin1String(typed), titled(title)); };
    QVERIFY(match("level", "Contour level") > match("lev", "Contour level"));
    QVERIFY(match("lev", "Contour level") > match("evel", "Contour level"));
    QVERIFY(match("evel", "Contour level") > match("cnlv", "Contour level"));
    QVERIFY(match("cnlv", "Contour level") > match("cnr", "Contour level"));
    QCOMPARE(match("evel", "Contour level")->way, PaletteMatch::Way::Text);
    QCOMPARE(match("cnlv", "Contour level")->way, PaletteMatch::Way::Letters);
    QCOMPARE(match("cnr", "Contour level")->way, PaletteMatch::Way::Scattered);
    QVERIFY(match("LEVEL con", "Contour level") > match("level", "Contour level"));
    QVERIFY(match("", "anything"));
    QVERIFY(match("light", "Light") > match("light", "Switch light/dark theme"));
    QVERIFY(match("curv", "Curvature") > match("curv", "Lesson 4: Curvature of a mirror"));
    QVERIFY(!match("level zebra", "Contour level"));
    QVERIFY(!match("vl", "Contour level"));  // two letters in order are in everything
    // One word of which only the letters match puts the item behind, however many words match wholly.
    QVERIFY(match("contour evel", "Contour level") > match("contour contour lvl", "Contour level"));
  }

  void scatteredLettersAreALastResort() {
    popUp();
    const QTreeWidget* list = window_->commandPalette()->list();
    for (const char* typed : {"light", "undo", "contour", "camera"}) {
      window_->commandPalette()->line()->setText(typed);
      QVERIFY2(list->topLevelItem(0)->text(0).contains(QLatin1String(typed), Qt::CaseInsensitive), typed);
      for (const PaletteItem& item : paletteItems(typed, window_->actions(), window_->document(), {})) {
        const std::optional<PaletteMatch> match = matchOf(typed, item);
        if (match && match->way == PaletteMatch::Way::Scattered) QVERIFY2(!shows(item), qPrintable(item.title));
      }
    }
    window_->commandPalette()->line()->setText("undo");
    QCOMPARE(list->topLevelItem(0)->text(0), QStringLiteral("Undo"));
    window_->commandPalette()->line()->setText("cotolel");  // nothing better
    QVERIFY(!list->topLevelItem(0)->isDisabled() && list->topLevelItemCount() < 20);
    bool found = false;
    for (int i = 0; i < list->topLevelItemCount(); ++i) found |= list->topLevelItem(i)->text(0) == "Contour level";
    QVERIFY(found);
  }

  void everyKnobOfTheWhatIfIsFoundAndGetsTheKeyboard() {
    const std::vector<WhatIfKnob> knobs =
        whatIfKnobs(*window_->document().scene(), 0, int(highlightsToMove(window_->document()).size()));
    QVERIFY(knobs.size() > 10);
    WhatIf synthetic;
    for (const bool synthesise : {false, true}) {
      synthetic.synthesise = synthesise;
      window_->document().setWhatIf(synthetic, "Synthesise");
      QTRY_VERIFY(window_->idle());
      for (const WhatIfKnob& knob : knobs) {
        popUp();
        window_->commandPalette()->line()->setText(toQString(knob.group + " " + knob.spec.title));
        const QTreeWidgetItem* row = window_->commandPalette()->list()->topLevelItem(0);
        QCOMPARE(row->text(0), toQString(knob.spec.title));
        QVERIFY(row->text(1).endsWith(toQString(knob.group)));
        QCOMPARE(row->text(2), valueText(knob.get(synthetic), knob.spec));
        QTest::keyClick(window_->commandPalette()->line(), Qt::Key_Return);
        const auto* slider = window_->findChild<QWidget*>(QLatin1String("slider:") + toQString(knob.spec.key));
        QVERIFY2(slider && slider->isVisible(), knob.spec.key.c_str());
        if (slider->isEnabled())
          QTRY_VERIFY2(window_->focusWidget() == slider,
                       qPrintable(toQString(knob.spec.key) + ": " +
                                  (window_->focusWidget() ? window_->focusWidget()->objectName() : QString())));
      }
    }
  }

  void aKnobIsSetByAnAssignment() {
    Document& document = window_->document();
    const int steps = document.undoStack()->count();
    popUp();
    type("turn about y = 2", Qt::Key_Return);
    QCOMPARE(document.undoStack()->count(), steps + 1);
    const auto turned = document.request().whatIf.poses.find(0);
    QVERIFY(turned != document.request().whatIf.poses.end());
    QVERIFY(std::abs(turned->second.rotation.y() - radians(2)) < 1e-12);
    for (const char* wrong : {"turn about y = 200", "turn about y = two"}) {
      popUp();
      type(wrong, Qt::Key_Return);
      QCOMPARE(document.undoStack()->count(), steps + 1);
      QVERIFY(window_->commandPalette()->list()->topLevelItem(0)->isDisabled());
      window_->commandPalette()->hide();
    }
  }

  void everyActionIsInAMenuAndInThePalette() {
    QSet<QAction*> inMenus;
    for (QAction* top : window_->menuBar()->actions()) collect(top->menu(), inMenus);
    popUp();
    QLineEdit* line = window_->commandPalette()->line();
    QVERIFY(window_->actions().all().size() > 20);
    for (QAction* action : window_->actions().all()) {
      QVERIFY2(inMenus.contains(action), qPrintable(Actions::id(action)));
      line->setText(Actions::title(action));
      bool found = false;
      const QTreeWidget* list = window_->commandPalette()->list();
      for (int i = 0; i < list->topLevelItemCount(); ++i) {
        const QTreeWidgetItem* row = list->topLevelItem(i);
        found |= row->text(0) == Actions::title(action) && Actions::path(action).startsWith(row->text(1));
      }
      QVERIFY2(found, qPrintable(Actions::id(action)));
    }
    // And nothing that menus show is missing from the registry, but the files opened lately.
    for (QAction* action : inMenus)
      if (!action->isSeparator() && action->isVisible())
        QVERIFY2(window_->actions().all().contains(action), qPrintable(action->text()));
  }

  void everyParameterIsFoundByItsNameAndItsKey() {
    popUp();
    for (const ParamSpec& spec : allParams())
      for (const std::string& typed : {spec.title, spec.key}) {
        window_->commandPalette()->line()->setText(toQString(typed));
        bool found = false;
        const QTreeWidget* list = window_->commandPalette()->list();
        for (int i = 0; i < list->topLevelItemCount(); ++i) found |= list->topLevelItem(i)->text(1).endsWith(toQString(spec.key));
        QVERIFY2(found, typed.c_str());
      }
  }

  void whatIsNamedSoComesBeforeWhatLiesThere() {
    popUp();
    window_->commandPalette()->line()->setText("light");
    const QTreeWidget* list = window_->commandPalette()->list();
    int named = 0, lying = 0;
    for (int i = 0; i < list->topLevelItemCount(); ++i) {
      const bool inTitle = list->topLevelItem(i)->text(0).contains(QRegularExpression(QStringLiteral("\\b[Ll]ight")));
      const bool inPlace = list->topLevelItem(i)->text(1).contains(QStringLiteral("light."));
      if (inTitle) QVERIFY2(lying == 0, qPrintable(list->topLevelItem(i)->text(0)));
      named += inTitle;
      lying += inPlace && !inTitle;
    }
    QVERIFY(named > 2 && lying > 2);  // "Light (estimate)"; "Bundle points", of light.bundle_points
  }

  /// The tool tip of the plot says "Logarithm of the radiance", the switch of the frame view "Linear radiance".
  void anItemIsFoundByOtherWordsForIt() {
    popUp();
    const auto finds = [this](const char* typed, const QString& title) {
      window_->commandPalette()->line()->setText(typed);
      const QTreeWidget* list = window_->commandPalette()->list();
      for (int i = 0; i < std::min(10, list->topLevelItemCount()); ++i)
        if (list->topLevelItem(i)->text(0) == title) return true;
      return false;
    };
    QVERIFY(finds("log radiance", "Lobe"));
    QVERIFY(finds("log radiance", "False colour"));
    QVERIFY(finds("false color", "False colour"));
    QVERIFY(finds("saturated", "Mark clipped pixels"));
    QVERIFY(finds("fills", "Show selection"));  // of its tool tip alone
    QVERIFY(finds("blinn-phong", "Lobe"));      // of its values alone
    QVERIFY(finds("axis front", "Front"));      // of its id
    // Items with the word in their name come before those with it in their explanation.
    window_->commandPalette()->line()->setText("theme");
    QCOMPARE(window_->commandPalette()->list()->topLevelItem(0)->text(0), QStringLiteral("Switch light/dark theme"));
  }

  void otherSpellingsAreUnderstood() {
    const auto matches = [](const char* typed, const char* title) {
      return matchOf(QLatin1String(typed), titled(title)).has_value();
    };
    QVERIFY(matches("gray", "Grey") && matches("center", "Centre") && matches("image", "Picture") && matches("axis", "Axes"));
    QVERIFY(matches("colors", "Colours") && matches("centers", "Centres"));
    QVERIFY(!matches("gray", "Centre"));
  }

  void whereNothingMatchesItSaysSo() {
    popUp();
    type("zzzzqq", Qt::Key_Return);
    const QTreeWidget* list = window_->commandPalette()->list();
    QCOMPARE(list->topLevelItemCount(), 1);
    QCOMPARE(list->topLevelItem(0)->text(0), QStringLiteral("No matching action or setting"));
    QVERIFY(list->topLevelItem(0)->isDisabled());
    QVERIFY(window_->commandPalette()->isVisible());
  }

  void itsKeysPressedAgainSelectWhatWasTyped() {
    popUp();
    QLineEdit* line = window_->commandPalette()->line();
    QTest::keyClicks(line, "contour");
    QTest::keyClick(line, Qt::Key_K, Qt::ControlModifier);
    QVERIFY(window_->commandPalette()->isVisible());
    QCOMPARE(line->selectedText(), QStringLiteral("contour"));
    QTest::keyClicks(line, "next");
    QCOMPARE(line->text(), QStringLiteral("next"));
  }

  void anActionRunsByTyping() {
    QVERIFY(window_->document().selection().frame == 0);
    popUp();
    type("next", Qt::Key_Return);
    QCOMPARE(window_->document().selection().frame, 1);
    QVERIFY(!window_->commandPalette()->isVisible());
  }

  void aParameterGetsTheKeyboard() {
    popUp();
    type("detect.level", Qt::Key_Return);
    QTRY_VERIFY(window_->focusWidget() && window_->focusWidget()->objectName() == "slider:detect.level");
  }

  void anAssignmentSetsAndIsOneStepOfUndo() {
    const int steps = window_->document().undoStack()->count();
    popUp();
    type("detect.level = 0.3", Qt::Key_Return);
    QCOMPARE(window_->document().request().settings.number("detect.level"), 0.3);
    QCOMPARE(window_->document().undoStack()->count(), steps + 1);
    popUp();
    type("detect.level = 7", Qt::Key_Return);  // out of range: the row says so and does nothing
    QCOMPARE(window_->document().request().settings.number("detect.level"), 0.3);
    QVERIFY(window_->commandPalette()->list()->topLevelItem(0)->isDisabled());
    // Among several with that name, the one that can take the value is meant; "Level-set contour" is a choice, "Level-set grid"
    // in px.
    popUp();
    type("level = 0.4", Qt::Key_Return);
    QCOMPARE(window_->document().request().settings.number("detect.level"), 0.4);
  }

  void aFrameIsFoundByItsNumber() {
    popUp();
    type("frame 0007", Qt::Key_Return);
    QCOMPARE(window_->document().selection().frame, 7);
  }

  /// The action that undoes the change of a frame has the frame's id in its title, too.
  void anIdFindsTheFrameBeforeTheUndoThatNamesIt() {
    window_->document().setRole(5, FrameRole::Excluded);
    popUp();
    window_->commandPalette()->line()->setText("0005");
    const QTreeWidget* list = window_->commandPalette()->list();
    QCOMPARE(list->topLevelItem(0)->text(0), QStringLiteral("Frame 0005"));
    QVERIFY2(list->topLevelItemCount() > 1 && list->topLevelItem(1)->text(0).startsWith("Undo"),
             qPrintable(list->topLevelItem(1)->text(0)));
    QTest::keyClick(window_->commandPalette()->line(), Qt::Key_Escape);
    window_->document().undoStack()->undo();
  }

  void aShortcutIsChangedKeptAndTakenFromItsOwner() {
    Actions& actions = window_->actions();
    ShortcutDialog dialog(actions, window_.get());
    dialog.show();
    auto* edit = dialog.findChild<QKeySequenceEdit*>("key:frame.play");
    QVERIFY(edit);
    const QKeySequence key(QStringLiteral("Ctrl+S"));  // that of "save"
    dialog.setShortcut(actions.find("frame.play"), key);
    QCOMPARE(actions.find("frame.play")->shortcut(), key);
    QVERIFY(!actions.find("file.save")->shortcuts().contains(key));
    {
      MainWindow another(fixture_.engine());
      QCOMPARE(another.actions().find("frame.play")->shortcut(), key);
    }
    actions.setShortcuts(actions.find("frame.play"), Actions::defaultShortcuts(actions.find("frame.play")));
    actions.setShortcuts(actions.find("file.save"), Actions::defaultShortcuts(actions.find("file.save")));
    MainWindow another(fixture_.engine());
    QCOMPARE(another.actions().find("frame.play")->shortcut(), QKeySequence(Qt::Key_P));
  }

  void enterInTheSearchOfShortcutsResetsNothingAndAResetAsks() {
    Actions& actions = window_->actions();
    ShortcutDialog dialog(actions, window_.get());
    const QKeySequence key(QStringLiteral("Ctrl+Shift+F9"));
    dialog.setShortcut(actions.find("frame.play"), key);
    dialog.show();
    QVERIFY(QTest::qWaitForWindowExposed(&dialog));
    auto* line = dialog.findChild<QLineEdit*>({}, Qt::FindDirectChildrenOnly);
    line->setFocus();
    QTest::keyClicks(line, QStringLiteral("play"));
    QTest::keyClick(line, Qt::Key_Return);
    QCOMPARE(actions.find("frame.play")->shortcut(), key);
    QVERIFY(dialog.isVisible());
    auto* reset = dialog.findChild<QPushButton*>(QStringLiteral("allShortcuts"));
    QVERIFY(reset);
    for (const auto& [answer, kept] : {std::pair(QMessageBox::No, true), std::pair(QMessageBox::Yes, false)}) {
      bool asked = false;
      QTimer::singleShot(0, &dialog, [&asked, answer = answer] {
        auto* box = qobject_cast<QMessageBox*>(QApplication::activeModalWidget());
        asked = box && box->button(answer);
        if (asked) box->button(answer)->click();
      });
      reset->click();
      QVERIFY(asked);
      QCOMPARE(actions.find("frame.play")->shortcut() == key, kept);
    }
  }

  void theColumnsOfThePaletteShareItsWidth() {
    popUp();
    const QTreeWidget* list = window_->commandPalette()->list();
    for (const char* typed : {"", "ctrl", "export", "show", "detect.level = 7"}) {
      window_->commandPalette()->line()->setText(typed);
      QCoreApplication::processEvents();
      QVERIFY2(list->columnWidth(0) + list->columnWidth(1) + list->columnWidth(2) <= list->viewport()->width(), typed);
      QVERIFY2(list->columnWidth(1) >= 80, typed);
      for (int i = 0; i < list->topLevelItemCount(); ++i) {
        const QString detail = list->topLevelItem(i)->text(2);
        if (detail.size() < 20)
          QVERIFY2(list->columnWidth(2) >= list->fontMetrics().horizontalAdvance(detail), qPrintable(detail));
      }
    }
  }

  void layersOfThe3dViewAreFoundAndSwitched() {
    for (const viz::Layer& layer : viz::sceneLayers()) {
      const QString title = toQString(layer.title);
      const auto row = [&] {
        for (const PaletteItem& item : paletteItems(title, window_->actions(), window_->document(), {}))
          if (item.title == title && item.place == QLatin1String("Layers of the 3D view")) return item;
        return PaletteItem{};
      };
      QVERIFY2(row().enabled && row().run, qPrintable(title));
      const bool before = window_->document().layerVisible(layer.name);
      QCOMPARE(row().detail, before ? QStringLiteral("on") : QStringLiteral("off"));
      row().run();
      QCOMPARE(window_->document().layerVisible(layer.name), !before);
      QCOMPARE(row().detail, before ? QStringLiteral("off") : QStringLiteral("on"));
    }
  }

  void noTwoActionsHaveTheSameKey() {
    QMap<QString, QString> owner;
    for (QAction* action : window_->actions().all())
      for (const QKeySequence& key : Actions::defaultShortcuts(action)) {
        QVERIFY2(!owner.contains(key.toString()), qPrintable(Actions::id(action) + " and " + owner.value(key.toString())));
        owner.insert(key.toString(), Actions::id(action));
      }
  }

 private:
  static PaletteItem titled(const char* title) { return {QLatin1String(title), {}, {}, true, {}, {}}; }
  bool shows(const PaletteItem& item) const {
    const QTreeWidget* list = window_->commandPalette()->list();
    for (int i = 0; i < list->topLevelItemCount(); ++i)
      if (list->topLevelItem(i)->text(0) == item.title && list->topLevelItem(i)->text(1) == item.place) return true;
    return false;
  }
  void popUp() {
    window_->actions().find("edit.palette")->trigger();
    QTRY_VERIFY(window_->commandPalette()->isVisible());
  }
  void type(const char* text, Qt::Key key) {
    QTest::keyClicks(window_->commandPalette()->line(), text);
    QTest::keyClick(window_->commandPalette()->line(), key);
  }
  Fixture fixture_;
  std::unique_ptr<MainWindow> window_;
};

QObject* makePaletteTest() { return new PaletteTest; }

}  // namespace glint::gui

#include "palette_test.moc"
