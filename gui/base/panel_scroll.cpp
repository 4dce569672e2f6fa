// SPDX-License-Identifier: BSD-3-Clause
#include "gui/base/panel_scroll.h"

#include <QEvent>
#include <QLayout>
#include <QScrollBar>
#include <QStyle>
#include <algorithm>

namespace glint::gui {

namespace {
QSize leastOf(const QWidget* content) { return content->minimumSizeHint().expandedTo(content->minimumSize()).expandedTo({0, 0}); }
}  // namespace

PanelScroll::PanelScroll(QWidget* content, QSize least, Height height) : least_(least), height_(height) {
  setFrameShape(QFrame::NoFrame);
  setWidget(content);
  content->installEventFilter(this);
  if (height_ == Height::Hugs) setSizePolicy(QSizePolicy::Preferred, QSizePolicy::Maximum);
}

void PanelScroll::setMost(int height) {
  if (height == most_) return;
  most_ = height;
  fit();
}

int PanelScroll::heightFor(int width, bool least) const {
  const QWidget* content = widget();
  if (content->isHidden()) return 0;
  if (const QLayout* layout = content->layout(); layout && layout->hasHeightForWidth())
    return least ? layout->minimumHeightForWidth(width) : layout->heightForWidth(width);
  if (content->hasHeightForWidth()) return std::max(content->heightForWidth(width), content->minimumHeight());
  return least ? leastOf(content).height() : content->sizeHint().height();
}

QSize PanelScroll::minimumSizeHint() const {
  const QSize content = leastOf(widget());
  const int height = height_ == Height::Hugs ? std::min(heightFor(std::max(width(), 1), false), least_.height())
                                             : std::min(content.height(), least_.height());
  return {std::min(content.width(), least_.width()), height};
}

QSize PanelScroll::sizeHint() const {
  const QSize content = widget()->sizeHint();
  return {content.width(), height_ == Height::Hugs ? heightFor(width(), false) : content.height()};
}

bool PanelScroll::event(QEvent* event) {
  const bool done = QScrollArea::event(event);
  // The content's sizes changed; or it was hidden while they did.
  if (event->type() == QEvent::LayoutRequest || event->type() == QEvent::Show) {
    updateGeometry();
    fit();
  }
  return done;
}

bool PanelScroll::eventFilter(QObject* watched, QEvent* event) {
  const QEvent::Type type = event->type();
  if (watched == widget() && (type == QEvent::ShowToParent || type == QEvent::HideToParent || type == QEvent::LayoutRequest)) {
    updateGeometry();
    fit();
  }
  return QScrollArea::eventFilter(watched, event);
}

void PanelScroll::resizeEvent(QResizeEvent* event) {
  QScrollArea::resizeEvent(event);
  fit();
}

void PanelScroll::fit() {
  QSize room = size();
  const bool hugs = height_ == Height::Hugs;
  const int all = hugs ? std::min(heightFor(room.width(), false), most_) : room.height();
  // It gets lower first: done within a resize event, the event that would fit the content to it again does not come.
  if (hugs && all < room.height()) room.setHeight(all);
  const bool least = !hugs;
  const int bar = style()->pixelMetric(QStyle::PM_ScrollBarExtent, nullptr, this);
  const int leastWidth = leastOf(widget()).width();
  int width = std::max(room.width(), leastWidth);
  const int across = width > room.width() ? bar : 0;  // the horizontal scroll bar takes height
  int height = heightFor(width, least);
  if (height > room.height() - across) {
    width = std::max(room.width() - bar, leastWidth);
    height = heightFor(width, least);
  }
  widget()->resize(width, std::max(height, room.height() - (width > room.width() ? bar : 0)));
  if (hugs && maximumHeight() != all) {
    setMaximumHeight(all);
    updateGeometry();
  }
  // Qt may have laid the bars out for the size that the content had before.
  const QScrollBar* vertical = verticalScrollBar();
  if (isVisible() && vertical->isVisible() != (vertical->maximum() > 0)) setVerticalScrollBarPolicy(verticalScrollBarPolicy());
}

}  // namespace glint::gui
