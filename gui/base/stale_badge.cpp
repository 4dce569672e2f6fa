// SPDX-License-Identifier: BSD-3-Clause
#include "gui/base/stale_badge.h"

#include <QAbstractScrollArea>
#include <QEvent>
#include <algorithm>
#include <utility>

namespace glint::gui {

StaleBadge::StaleBadge(QWidget* panel, Qt::Corner corner) : QLabel(tr("updating…"), panel), corner_(corner) {
  setObjectName(QStringLiteral("staleBadge"));
  setAttribute(Qt::WA_TransparentForMouseEvents);
  // The same chip as in the frame view, in both themes.
  setStyleSheet(QStringLiteral("background: rgba(0, 0, 0, 200); color: #f0c050; border-radius: 4px; padding: 2px 6px;"));
  later_.setSingleShot(true);
  later_.setInterval(kAfterMs);
  connect(&later_, &QTimer::timeout, this, [this] {
    place();
    raise();
    show();
    mark(true);
  });
  panel->installEventFilter(this);
  if (const auto* scrolled = qobject_cast<QAbstractScrollArea*>(panel)) scrolled->viewport()->installEventFilter(this);
  hide();
}

void StaleBadge::setStale(bool stale) {
  if (!stale) {
    later_.stop();
    hide();
    mark(false);
  } else if (isHidden() && !later_.isActive()) {
    later_.start();
  }
}

void StaleBadge::mark(bool stale) {
  if (std::exchange(marks_, stale) != stale) emit marked(stale);
}

void StaleBadge::setUpdating(bool updating) {
  const QString words = updating ? tr("updating…") : tr("out of date");
  if (words == text()) return;  // a slider asks for it with every step
  setText(words);
  place();
}

bool StaleBadge::eventFilter(QObject* watched, QEvent* event) {
  if (event->type() == QEvent::Resize) place();
  return QLabel::eventFilter(watched, event);
}

void StaleBadge::place() {
  constexpr int kMargin = 8;
  adjustSize();
  const auto* scrolled = qobject_cast<const QAbstractScrollArea*>(parentWidget());  // whose bars would cover it
  const QRect area = scrolled ? scrolled->viewport()->geometry() : parentWidget()->rect();
  const int below = area.y() + std::max(0, area.height() - height() - kMargin);
  move(area.right() + 1 - width() - kMargin, corner_ == Qt::TopRightCorner ? area.y() + kMargin : below);
}

}  // namespace glint::gui
