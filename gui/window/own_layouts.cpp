// SPDX-License-Identifier: BSD-3-Clause
#include "gui/window/own_layouts.h"

#include <QAction>
#include <QMainWindow>
#include <QMenu>
#include <QSettings>
#include <QSplitter>

namespace glint::gui {

namespace {
constexpr int kVersion = 1;  // of what is kept: a window with other docks gets another
QString key(int place, const char* part) { return QStringLiteral("layouts/own-%1/%2").arg(place).arg(QLatin1String(part)); }
}  // namespace

OwnLayouts::OwnLayouts(QMainWindow* window, QSplitter* views) : QObject(window), window_(window), views_(views) {}

void OwnLayouts::addActions(Actions& actions, QMenu* menu) {
  for (int place = 1; place <= kPlaces; ++place)
    goTo_ << actions.add(QStringLiteral("view.layout-own-%1").arg(place), menu, tr("Own layout &%1").arg(place),
                         [this, place] { apply(place); });
  QMenu* keepMenu = menu->addMenu(tr("&Save current layout"));
  for (int place = 1; place <= kPlaces; ++place)
    actions.add(QStringLiteral("view.layout-keep-%1").arg(place), keepMenu, tr("Save as own layout &%1").arg(place),
                [this, place] { keep(place); });
  refresh();
}

bool OwnLayouts::has(int place) const { return QSettings().contains(key(place, "docks")); }

void OwnLayouts::keep(int place) {
  QSettings settings;
  settings.setValue(key(place, "docks"), window_->saveState(kVersion));
  settings.setValue(key(place, "views"), views_->saveState());
  refresh();
}

void OwnLayouts::apply(int place) {
  if (!has(place)) return;
  const QSettings settings;
  window_->restoreState(settings.value(key(place, "docks")).toByteArray(), kVersion);
  views_->restoreState(settings.value(key(place, "views")).toByteArray());
  emit applied();
}

void OwnLayouts::refresh() {
  for (int place = 1; place <= goTo_.size(); ++place) goTo_[place - 1]->setEnabled(has(place));
}

}  // namespace glint::gui
