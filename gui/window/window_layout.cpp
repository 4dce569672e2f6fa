// SPDX-License-Identifier: BSD-3-Clause
#include "gui/window/window_layout.h"

#include <QDockWidget>
#include <QMainWindow>
#include <QSplitter>
#include <QTimer>
#include <utility>

namespace glint::gui {

WindowLayout::WindowLayout(QMainWindow* window, Docks& docks, QSplitter* views)
    : QObject(window), window_(window), docks_(docks), views_(views) {}

void WindowLayout::apply(const QString& name) {
  const Layout& layout = layoutByName(name);
  name_ = QLatin1String(layout.name);
  own_ = hidden_ = false;
  before_.reset();  // what was chosen meanwhile stays
  docks_.apply(layout);
  views_->setSizes({layout.sceneShare * 10, (100 - layout.sceneShare) * 10});
}

void WindowLayout::hideUntilOpen() {
  hidden_ = true;
  docks_.hideAll();
}

void WindowLayout::showAgain() {
  if (hidden_) apply(name_);
}

void WindowLayout::setOwn() {
  own_ = true;
  hidden_ = false;
  before_.reset();
}

bool WindowLayout::makeRoomFor(const QString& dock, bool rearrange) {
  const auto* widget = window_->findChild<QDockWidget*>(dock);
  const bool arranged = own_ ? widget && !widget->isHidden() : name_ == dock;
  const bool covered = widget && Docks::isBehind(widget);
  if (rearrange && (!arranged || covered)) {
    const Arrangement before{name_, own_, window_->size(), window_->saveState(), views_->saveState()};
    if (!arranged) apply(dock);
    before_ = before;
  }
  docks_.bring(dock);
  return before_.has_value() && !arranged;
}

void WindowLayout::putBack() {
  if (!before_) return;
  const Arrangement before = *std::exchange(before_, std::nullopt);
  if (!before.own) apply(before.name);  // also arranges the docks for what the window's size is by now
  name_ = before.name;
  own_ = before.own;
  if (!before.own && before.size != window_->size()) return;
  window_->restoreState(before.docks);
  views_->restoreState(before.views);
}

void WindowLayout::followSize() {
  if (own_ || hidden_ || name_.isEmpty() || !window_->isVisible() || docks_.fits()) return;
  QTimer::singleShot(0, this, [this] {  // not while Qt lays out the docks
    if (!own_ && !hidden_ && !docks_.fits()) apply(name_);
  });
}

QSize WindowLayout::leastSize(QSize needs) const { return own_ ? QSize(0, 0) : docks_.least(needs); }

}  // namespace glint::gui
