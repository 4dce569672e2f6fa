// SPDX-License-Identifier: BSD-3-Clause
#include "gui/window/docks.h"

#include <QAbstractScrollArea>
#include <QAction>
#include <QDockWidget>
#include <QLayout>
#include <QMenu>
#include <QScrollArea>
#include <QStringList>
#include <algorithm>
#include <utility>

#include "core/base/outcome.h"
#include "gui/base/panel_scroll.h"

namespace glint::gui {

namespace {
constexpr int kNarrow = 1100, kLow = 900;  // below these, px, columns of docks would leave the views too little
constexpr int kTimeline = 150;             // px: its rows and an axis that is read
constexpr int kBeside = 330;               // px: sliders with their names
constexpr double kErrors = 0.32;           // of the height: summary, choice of rows and four rows of the table
constexpr QSize kLeastContent(150, 80);
constexpr QSize kAsTabs(800, 500);  // what every layout fits into then

/// What a dock of this width needs to show all of its content, px.
int wholeHeight(const QDockWidget& dock, int width) {
  const auto* scroll = qobject_cast<const QScrollArea*>(dock.widget());
  const QLayout* layout = scroll && scroll->widget() ? scroll->widget()->layout() : nullptr;
  const int height = dock.sizeHint().height();
  if (!layout || !layout->hasHeightForWidth()) return height;
  return height - scroll->sizeHint().height() + layout->totalHeightForWidth(width);
}
}  // namespace

QDockWidget* Docks::add(const char* name, const QString& title, QWidget* content, Qt::DockWidgetArea area, const char* behind) {
  auto* dock = new QDockWidget(title, window_);
  dock->setObjectName(QLatin1String(name));
  const bool scrolls = qobject_cast<QAbstractScrollArea*>(content) != nullptr;
  dock->setWidget(scrolls ? content : new PanelScroll(content, kLeastContent));
  if (dock->widget()->accessibleName().isEmpty()) dock->widget()->setAccessibleName(title);  // the keyboard stops at it, too
  // A field in a tab that goes behind another one would go on taking the keys, unseen.
  QObject::connect(dock, &QDockWidget::visibilityChanged, window_, [this, dock](bool visible) {
    if (const QWidget* focus = window_->focusWidget(); !visible && focus && dock->isAncestorOf(focus)) window_->setFocus();
  });
  docks_.insert(QLatin1String(name), dock);
  places_.append({QLatin1String(name), area, QLatin1String(behind)});
  return dock;
}

Docks::Room Docks::room() const { return {window_->width() < kNarrow, window_->height() < kLow}; }

QSize Docks::least(QSize needs) const {
  if (!room_) return needs;
  if (!room_->narrow && needs.width() < kNarrow) needs.setWidth(std::min(needs.width(), kAsTabs.width()));
  if (!room_->low && needs.height() < kLow) needs.setHeight(std::min(needs.height(), kAsTabs.height()));
  return needs;
}

QString Docks::host(const Place& place, const Room& room) const {
  static const QStringList left{"setup", "layers", "tree", "history"}, right{"conditioning", "numbers"},
      bottom{"timeline", "plots"};
  if (room.narrow && left.contains(place.name)) return QStringLiteral("parameters");
  if (room.low && left.contains(place.name) && place.name != left.front()) return left.front();
  if (room.low && right.contains(place.name)) return QStringLiteral("parameters");
  if (room.low && bottom.contains(place.name)) return QStringLiteral("errors");
  if (room.narrow && place.name == bottom.back()) return QStringLiteral("errors");
  return place.behind;
}

void Docks::arrange(const Room& room) {
  room_ = room;
  // First all that have a place of their own: Qt would make what is split off from a tab one too.
  for (const Place& place : std::as_const(places_))
    if (host(place, room).isEmpty()) {
      window_->addDockWidget(place.area, at(place.name));
      if (place.name == QLatin1String("errors") && !room.low)
        window_->splitDockWidget(at(QStringLiteral("timeline")), at(place.name), Qt::Vertical);
      if (place.name == QLatin1String("plots"))
        window_->splitDockWidget(at(QStringLiteral("errors")), at(place.name), Qt::Horizontal);
    }
  for (const Place& place : std::as_const(places_))
    if (const QString behind = host(place, room); !behind.isEmpty()) {
      window_->addDockWidget(place.area, at(place.name));
      window_->tabifyDockWidget(at(behind), at(place.name));
    }
}

QDockWidget* Docks::at(const QString& name) const {
  QDockWidget* dock = docks_.value(name);
  require(dock != nullptr, "Docks: no dock named " + name.toStdString());
  return dock;
}

void Docks::keepVisible(const QString& name, std::function<bool()> needed) {
  kept_ = name;
  needed_ = std::move(needed);
}

void Docks::keepLow(const QString& name) {
  window_->layout()->activate();
  window_->resizeDocks({at(name)}, {kTimeline + 4 * window_->fontMetrics().lineSpacing()}, Qt::Vertical);
}

void Docks::hideAll() {
  for (QDockWidget* dock : std::as_const(docks_)) dock->hide();
}

bool Docks::wouldCover(QDockWidget* dock) const {
  if (kept_.isEmpty() || !needed_()) return false;
  QDockWidget* const kept = at(kept_);
  return dock != kept && !kept->isHidden() && !kept->isFloating() && !isBehind(kept) &&
         (window_->tabifiedDockWidgets(kept).contains(dock) || dock->isHidden()) &&
         window_->dockWidgetArea(dock) == Qt::RightDockWidgetArea;
}

void Docks::bring(const QString& name) {
  QDockWidget* const dock = at(name);
  if (wouldCover(dock)) {
    moved_ = true;
    if (room_ && room_->narrow) {
      window_->addDockWidget(Qt::RightDockWidgetArea, dock);
      window_->splitDockWidget(at(kept_), dock, Qt::Vertical);
    } else {
      window_->addDockWidget(Qt::LeftDockWidgetArea, dock);
      window_->resizeDocks({dock}, {std::min(kBeside, window_->width() * 22 / 100)}, Qt::Horizontal);
    }
  }
  const bool appears = dock->isHidden();
  dock->show();
  dock->raise();
  if (!appears || dock->isFloating() || window_->dockWidgetArea(dock) != Qt::BottomDockWidgetArea) return;
  // A layout without this dock has left it the height of nothing.
  window_->layout()->activate();
  if (const int height = window_->height() * 3 / 10; name != QLatin1String("timeline") && dock->height() < height * 2 / 3)
    window_->resizeDocks({at("timeline"), dock}, {kTimeline, height}, Qt::Vertical);
}

void Docks::apply(const Layout& layout) {
  if (const Room now = room(); std::exchange(moved_, false) || !(room_ && *room_ == now)) arrange(now);
  for (const Place& place : std::as_const(places_)) {
    // What is a tab behind another dock follows it, unless the layout names it itself.
    const QString& follows = place.behind.isEmpty() ? place.name : place.behind;
    at(place.name)->setVisible(layout.docks.contains(place.name) || layout.docks.contains(follows));
  }
  for (const char* front : {"errors", "tree", "parameters"}) at(QLatin1String(front))->raise();
  for (const QString& front : layout.front) at(front)->raise();
  if (needed_ && needed_()) {  // a lesson that leads to a layout is read on beside it
    at(kept_)->show();
    at(kept_)->raise();
  }
  const int width = window_->width(), height = window_->height(), right = std::min(380, width * 32 / 100),
            left = std::min(260, width * 18 / 100);
  if (room_->narrow)
    window_->resizeDocks({at("parameters")}, {right}, Qt::Horizontal);
  else
    window_->resizeDocks({at("setup"), at("parameters")}, {left, right}, Qt::Horizontal);
  if (room_->low) {
    const bool timelineAlone = at("errors")->isHidden() && at("plots")->isHidden();
    return window_->resizeDocks({at(timelineAlone ? QStringLiteral("timeline") : QStringLiteral("errors"))},
                                {timelineAlone ? kTimeline : height * 3 / 10}, Qt::Vertical);
  }
  window_->resizeDocks({at("timeline"), at("errors")}, {kTimeline, int(height * kErrors)}, Qt::Vertical);
  if (!room_->narrow) window_->resizeDocks({at("setup")}, {wholeHeight(*at("setup"), left)}, Qt::Vertical);
  // The reason below the verdicts is in sight, with two lights, too.
  window_->resizeDocks({at("parameters"), at("conditioning"), at("numbers")}, {350, 350, 200}, Qt::Vertical);
  if (!room_->narrow) window_->resizeDocks({at("errors"), at("plots")}, {1, 1}, Qt::Horizontal);
}

bool Docks::isBehind(const QWidget* widget) {
  for (; widget; widget = widget->parentWidget())
    if (const auto* dock = qobject_cast<const QDockWidget*>(widget)) return dock->visibleRegion().isEmpty();
  return false;
}

void Docks::addActions(Actions& actions, QMenu* menu) {
  for (auto it = docks_.begin(); it != docks_.end(); ++it) {
    QDockWidget* dock = it.value();
    const auto run = [this, dock, name = it.key()](bool) {
      if (dock->isVisible() && !isBehind(dock)) return dock->hide();
      bring(name);
    };
    QAction* action = actions.addToggle("view.panel-" + it.key(), menu, dock->windowTitle(), run, {});
    const auto follow = [action, dock] { action->setChecked(!dock->isHidden()); };
    QObject::connect(dock->toggleViewAction(), &QAction::toggled, action, follow);
    QObject::connect(action, &QAction::triggered, action, follow);
    follow();
  }
}

}  // namespace glint::gui
