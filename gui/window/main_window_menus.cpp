// SPDX-License-Identifier: BSD-3-Clause
// The menus of the window, its tool bar and the palette.
#include <QAbstractButton>
#include <QMenuBar>
#include <QSplitter>
#include <QToolBar>
#include <QUndoStack>

#include "gui/explain/explain_panel.h"
#include "gui/export/export_actions.h"
#include "gui/frame/frame_panel.h"
#include "gui/frame/ladder_panel.h"
#include "gui/lamps/lamps_in_window.h"
#include "gui/panels/comparison_panel.h"
#include "gui/panels/diagnosis_panel.h"
#include "gui/panels/error_table.h"
#include "gui/panels/log_panel.h"
#include "gui/panels/numbers_panel.h"
#include "gui/panels/parameter_panel.h"
#include "gui/plots/plots_panel.h"
#include "gui/scene/scene_panel.h"
#include "gui/scene/scene_tree.h"
#include "gui/scene/scene_views.h"
#include "gui/timeline/timeline.h"
#include "gui/whatif/what_if_panel.h"
#include "gui/window/context_menus.h"
#include "gui/window/file_actions.h"
#include "gui/window/main_window.h"
#include "gui/window/own_layouts.h"
#include "gui/window/palette.h"
#include "gui/window/palette_items.h"
#include "gui/window/pinned_results.h"
#include "gui/window/shortcut_dialog.h"
#include "gui/window/teaching.h"
#include "gui/window/unreadable_files.h"
#include "gui/window/window_layout.h"

namespace glint::gui {

void MainWindow::buildMenus() {
  QMenu* file = menuBar()->addMenu(tr("&File"));
  fillFileMenu(file);
  fillEditMenu(menuBar()->addMenu(tr("&Edit")));

  QMenu* frame = menuBar()->addMenu(tr("F&rame"));
  timeline_->addActions(actions_, frame);
  frame->addSeparator();
  frame_->addActions(actions_, frame);
  ladder_->addActions(actions_, frame);

  QMenu* plots = menuBar()->addMenu(tr("&Plots"));
  plots_->addActions(actions_, plots);
  plots->addSeparator();
  actions_.add("plots.measure", plots, tr("Measure speed and &accuracy"), [this] {
    docks_.bring(QStringLiteral("tradeoff"));
    press("measureTradeoff");
  });
  diagnosis_->addActions(actions_, plots, [this] { docks_.bring(QStringLiteral("problems")); });
  lamps_->addActions(actions_, plots, file);

  QMenu* view = menuBar()->addMenu(tr("&View"));
  fillViewMenu(view);
  explain_->addActions(actions_, menuBar()->addMenu(tr("E&xplain")));
  teaching_->addActions(actions_, menuBar()->addMenu(tr("&Help")), view);
  connect(teaching_, &Teaching::frameRequested, this, [this](int by) { timeline_->strip()->step(by); });

  QToolBar* bar = addToolBar(tr("Tools"));
  bar->setObjectName(QStringLiteral("tools"));
  bar->setMovable(false);
  bar->setIconSize({18, 18});
  for (const char* id : {"file.open", "file.save", "", "edit.undo", "edit.redo", "", "view.frame-all", "view.look-through",
                         "frame.highlight", "", "view.theme"}) {
    if (QAction* action = actions_.find(QLatin1String(id)))
      bar->addAction(action);
    else
      bar->addSeparator();
  }
  actions_.loadShortcuts();
  offerMenus(actions_, *frame_, *plots_, *errors_);
}

void MainWindow::fillFileMenu(QMenu* file) {
  files_->addActions(actions_, file);
  file->addSeparator();
  comparison_->addActions(actions_, file);
  unreadable_->addActions(actions_, file);
  exports_->setViews(*scene_, *frame_);
  exports_->addActions(actions_, file->addMenu(tr("&Export")));
  log_->setReport(actions_.find("export.diagnostic"));
  file->addSeparator();
  actions_.add("file.quit", file, tr("&Quit"), [this] { close(); }, {QKeySequence::keyBindings(QKeySequence::Quit)});
}

void MainWindow::fillEditMenu(QMenu* edit) {
  QUndoStack* stack = document_.undoStack();
  actions_.adopt("edit.undo", edit, stack->createUndoAction(this, tr("&Undo")), {{QKeySequence::Undo}, "undo"});
  actions_.adopt("edit.redo", edit, stack->createRedoAction(this, tr("&Redo")), {{QKeySequence::Redo}, "redo"});
  edit->addSeparator();
  actions_.add("edit.copy-numbers", edit, tr("Copy &numbers"), [this] { numbers_->copy(); }, {{}, "copy"});
  errors_->addActions(actions_, edit);
  connect(errors_, &ErrorTable::shown, this, [this] { docks_.bring(QStringLiteral("errors")); });
  actions_.add("edit.stop", edit, tr("&Stop computation"),
               [this] {
                 runner_.cancel();
                 exports_->longJob()->cancel();
               },
               {{Qt::Key_Escape}, "stop"});
  // Actions with a button in a panel are in menus and the palette, too.
  edit->addSeparator();
  actions_.add("edit.auto-model", edit, tr("Choose &model automatically"), [this] { press("autoModel"); });
  actions_.add("edit.what-if-back", edit, tr("Reset &what-if"), [this] { press("whatif.reset"); });

  edit->addSeparator();
  buildPalette();
  palette_->setOpener(actions_.add("edit.palette", edit, tr("&Find action, setting or frame…"), [this] { palette_->popUp(); },
                                   {{QKeySequence("Ctrl+K"), QKeySequence("Ctrl+Shift+P")}}));
  actions_.add("edit.shortcuts", edit, tr("&Keyboard shortcuts…"), [this] { ShortcutDialog(actions_, this).exec(); });
}

void MainWindow::fillViewMenu(QMenu* view) {
  scene_->addActions(actions_, view);
  tree_->addActions(actions_, view);
  view->addSeparator();
  QMenu* layoutMenu = view->addMenu(tr("&Layout"));
  for (const Layout& layout : layouts()) {
    const QString name = QString::fromLatin1(layout.name);
    actions_.add("view.layout-" + name, layoutMenu, tr(layout.title), [this, name] { applyLayout(name); });
  }
  layoutMenu->addSeparator();
  auto* own = new OwnLayouts(this, views_);
  own->addActions(actions_, layoutMenu);
  connect(own, &OwnLayouts::applied, layout_, &WindowLayout::setOwn);
  docks_.addActions(actions_, view->addMenu(tr("&Panels")));
  view->addSeparator();
  actions_.add("view.theme", view, tr("Switch light/dark &theme"),
               [this] {
                 setTheme(currentTheme() == Theme::Dark ? Theme::Light : Theme::Dark);
                 keepTheme(currentTheme());
               },
               {{}, "theme"});

  auto* pinned = new PinnedResults(document_, {scene_, frame_}, this);
  pinned->addActions(actions_, view);
  connect(pinned, &PinnedResults::message, this, &MainWindow::tell);
}

void MainWindow::buildPalette() {
  palette_ = new Palette(
      [this](const QString& typed) {
        const auto leadTo = [this](const char* dock, auto show) {
          return [this, dock, show](const std::string& key) {
            docks_.bring(QLatin1String(dock));
            show(key);
          };
        };
        return paletteItems(typed, actions_, document_,
                            {leadTo("parameters", [this](const std::string& key) { parameters_->showParameter(key); }),
                             leadTo("what-if", [this](const std::string& key) { whatIf_->showKnob(key); }),
                             [this] { return scene_->views().activeView(); }});
      },
      this);
}

void MainWindow::press(const char* button) { findChild<QAbstractButton*>(QLatin1String(button))->click(); }

}  // namespace glint::gui
