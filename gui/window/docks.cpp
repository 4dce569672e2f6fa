// SPDX-License-Identifier: BSD-3-Clause
#include "gui/window/docks.h"

#include <QAction>
#include <QDockWidget>
#include <QMenu>

#include "core/base/outcome.h"

namespace glint::gui {

QDockWidget* Docks::add(const char* name, const QString& title, QWidget* content, Qt::DockWidgetArea area, const char* behind) {
  auto* dock = new QDockWidget(title);
  dock->setObjectName(QLatin1String(name));
  dock->setWidget(content);
  window_->addDockWidget(area, dock);
  docks_.insert(QLatin1String(name), dock);
  if (QDockWidget* host = docks_.value(QLatin1String(behind))) {
    window_->tabifyDockWidget(host, dock);
    host->raise();
    hosts_.insert(QLatin1String(name), QLatin1String(behind));
  }
  return dock;
}

QDockWidget* Docks::at(const QString& name) const {
  QDockWidget* dock = docks_.value(name);
  require(dock != nullptr, "Docks: there is no dock " + name.toStdString());
  return dock;
}

void Docks::bring(const QString& name) {
  at(name)->show();
  at(name)->raise();
}

void Docks::apply(const Layout& layout) {
  for (auto dock = docks_.begin(); dock != docks_.end(); ++dock) {
    // What is a tab behind another dock follows it, unless the layout names it itself.
    const QString host = hosts_.value(dock.key(), dock.key());
    dock.value()->setVisible(layout.docks.contains(dock.key()) || layout.docks.contains(host));
  }
  for (const char* front : {"errors", "layers", "parameters"}) at(QLatin1String(front))->raise();
  for (const QString& front : layout.front) at(front)->raise();
  window_->resizeDocks({at("setup"), at("parameters")}, {230, 380}, Qt::Horizontal);
  window_->resizeDocks({at("timeline"), at("errors")}, {150, window_->height() * 3 / 10}, Qt::Vertical);
  window_->resizeDocks({at("setup"), at("layers")}, {284, 264}, Qt::Vertical);
  window_->resizeDocks({at("parameters"), at("conditioning"), at("numbers")}, {400, 290, 210}, Qt::Vertical);
  window_->resizeDocks({at("errors"), at("plots")}, {1, 1}, Qt::Horizontal);
}

void Docks::addActions(Actions& actions, QMenu* menu) {
  for (auto it = docks_.begin(); it != docks_.end(); ++it) {
    QDockWidget* dock = it.value();
    const auto run = [dock](bool) {
      if (dock->isVisible() && !dock->visibleRegion().isEmpty()) return dock->hide();
      dock->show();
      dock->raise();
    };
    QAction* action = actions.addToggle("view.panel-" + it.key(), menu, dock->windowTitle(), run, {});
    const auto follow = [action, dock] { action->setChecked(!dock->isHidden()); };
    QObject::connect(dock->toggleViewAction(), &QAction::toggled, action, follow);
    QObject::connect(action, &QAction::triggered, action, follow);
    follow();
  }
}

}  // namespace glint::gui
