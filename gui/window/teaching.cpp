// SPDX-License-Identifier: BSD-3-Clause
#include "gui/window/teaching.h"

#include <QAction>
#include <QCoreApplication>
#include <QEvent>
#include <QLayout>
#include <QMainWindow>
#include <QMenu>
#include <utility>

#include "gui/explain/duality_window.h"
#include "gui/explain/equation_browser.h"
#include "gui/explain/explain_panel.h"
#include "gui/explain/walk_player.h"
#include "gui/frame/frame_panel.h"
#include "gui/scene/scene_panel.h"
#include "gui/scene/scene_views.h"
#include "gui/window/about.h"
#include "gui/window/docks.h"
#include "gui/window/present.h"
#include "gui/window/reader.h"
#include "gui/window/shortcut_dialog.h"
#include "gui/window/symbol_links.h"
#include "gui/window/window_layout.h"

namespace glint::gui {

Teaching::Teaching(const Parts& parts) : QObject(parts.window), parts_(parts) {
  ExplainPanel& explain = parts_.explain;
  connect(&explain, &ExplainPanel::started, this, &Teaching::makeRoom);
  connect(&explain, &ExplainPanel::left, this, &Teaching::putBack);
  connect(&explain, &ExplainPanel::look, &parts_.scene, &ScenePanel::look);
  connect(&explain, &ExplainPanel::look, &parts_.frame, &FramePanel::look);
  connect(&explain, &ExplainPanel::readRequested, this, &Teaching::read);
  connect(&explain, &ExplainPanel::panelRequested, this, [this](const QString& dock) { parts_.docks.bring(dock); });
  connect(&explain.walk(), &WalkPlayer::changed, this, [this] {
    const WalkPlayer& walk = parts_.explain.walk();
    parts_.scene.showWalk(walk.story(), walk.step(), walk.playing());
    parts_.frame.showWalk(walk.story(), walk.step());
  });
  auto* links = new SymbolLinks(explain.text(), parts_.scene.views(), this);
  connect(&explain, &ExplainPanel::dualityOpened, links, [links](DualityWindow* window) { links->follow(*window); });
  connect(&parts_.document, &Document::sceneOpened, this, [this] {
    viewsBefore_.clear();
    explained_ = parts_.document.sharedScene();  // by now the panel has left the one before
  });
  // A step's text stays in sight beside what it asks the reader to turn.
  parts_.docks.keepVisible(QStringLiteral("explain"), [this] { return teaches(); });
  present_ = new Present(parts_.window, [this] {
    parts_.docks.hideAll();
    parts_.docks.bring(QStringLiteral("timeline"));
    if (teaches()) parts_.docks.bring(QStringLiteral("explain"));
    parts_.docks.keepLow(QStringLiteral("timeline"));
  });
  connect(present_, &Present::changed, this, [this] { parts_.scene.views().setTextScale(present_->textScale()); });
  connect(present_, &Present::step, this, [this](int by) {
    if (parts_.explain.step() < 0 && parts_.document.option("explain/lesson", std::string()).empty())
      return emit frameRequested(by);
    by > 0 ? parts_.explain.next() : parts_.explain.back();
  });
}

/// A text is there to be read: a step's, or a lesson's.
bool Teaching::teaches() const {
  return parts_.explain.step() >= 0 || !parts_.document.option("explain/lesson", std::string()).empty();
}

/// A text and a 3D view that fit beside each other.
void Teaching::makeRoom() {
  if (parts_.explain.step() < 0 && parts_.document.scene()) viewsBefore_ = parts_.scene.viewPoints();
  // Without a scene there is only the overview.
  if (!parts_.layout.makeRoomFor(QStringLiteral("explain"), parts_.document.scene() != nullptr)) return;
  // A step fits the view to what it is about: the view has to know its new size by then.
  parts_.window->layout()->activate();
  QCoreApplication::sendPostedEvents(nullptr, QEvent::LayoutRequest);
  parts_.scene.renderNow();
}

void Teaching::putBack() {
  parts_.layout.putBack();
  if (parts_.document.sharedScene() != explained_) return;  // another scene was opened, and has views of its own
  parts_.frame.look(QStringLiteral("scene"), -1);
  if (const std::vector<viz::ViewPoint> before = std::exchange(viewsBefore_, {}); !before.empty())
    parts_.scene.lookFrom(before);
  else if (parts_.document.scene())
    parts_.scene.look(QStringLiteral("scene"), -1, {});
}

void Teaching::read(const QString& page, const QString& place) {
  if (!reader_) reader_ = new Reader(parts_.window);
  reader_->openPage(page, place);
}

void Teaching::addActions(Actions& actions, QMenu* help, QMenu* view) {
  const auto page = [&](const char* id, const QString& title, const QString& tip) {
    actions.add(QStringLiteral("help.") + QLatin1String(id), help, title, [this, id = QString::fromLatin1(id)] { read(id); },
                {{}, {}, tip});
  };
  // Escape leads back from a camera wherever the focus is, unless there is something to stop.
  if (QAction* stop = actions.find(QStringLiteral("edit.stop")))
    connect(stop, &QAction::triggered, this, [this, &actions] {
      for (const char* through : {"view.look-through", "view.look-through-virtual"})
        if (QAction* eye = actions.find(QLatin1String(through)); eye && eye->isChecked() && !parts_.document.stale())
          eye->trigger();
    });
  page("manual", tr("&Manual"), tr("What each part of the window does"));
  page("method", tr("M&ethod"), tr("How Glint gets from photographs to a prediction, with the equations"));
  page("notation", tr("&Notation"), tr("Terms and symbols"));
  page("glossary", tr("&Glossary"), tr("The terms in plain words"));
  actions.add("help.shortcuts", help, tr("&Keyboard shortcuts…"),
              [this, &actions] { ShortcutDialog(actions, parts_.window).exec(); });
  help->addSeparator();
  actions.add("help.about", help, tr("&About Glint"), [this] { showAbout(parts_.window); });
  QAction* present = actions.addToggle(
      "view.present", view, tr("P&resent on the whole screen"), [this](bool) { present_->toggle(); },
      {{QKeySequence("Shift+F5")}, {}, tr("Large texts, no menus; Page down and up step, B blackens, Esc leaves")});
  connect(present_, &Present::changed, present, &QAction::setChecked);
}

}  // namespace glint::gui
