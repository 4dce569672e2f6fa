// SPDX-License-Identifier: BSD-3-Clause
#include "gui/window/fit_on_screen.h"

#include <QEvent>
#include <QScreen>
#include <QTimer>
#include <QWidget>
#include <QWindow>
#include <algorithm>
#include <utility>

namespace glint::gui {

namespace {
constexpr int kMomentMs = 2000;  // window managers answer within some 100 ms
}

QRect contentWithin(const QRect& content, const QMargins& frame, const QRect& available) {
  const QRect room = available.marginsRemoved(frame);
  QRect fitted(content.topLeft(), content.size().boundedTo(room.size()));
  fitted.moveLeft(std::clamp(fitted.left(), room.left(), room.left() + room.width() - fitted.width()));
  fitted.moveTop(std::clamp(fitted.top(), room.top(), room.top() + room.height() - fitted.height()));
  return fitted;
}

FitOnScreen::FitOnScreen(QWidget* window, std::function<QMargins()> frame)
    : QObject(window), window_(window), frame_(std::move(frame)) {
  if (!frame_) frame_ = [window] { return window->windowHandle() ? window->windowHandle()->frameMargins() : QMargins(); };
  window->installEventFilter(this);
}

bool FitOnScreen::eventFilter(QObject* watched, QEvent* event) {
  if (watched == window_ && event->type() == QEvent::Show && !std::exchange(shown_, true)) {
    QTimer::singleShot(kMomentMs, this, &QObject::deleteLater);
    // The frame may come without any event of the window.
    for (const int ms : {0, 50, 150, 400, 1000}) QTimer::singleShot(ms, this, &FitOnScreen::fit);
  }
  if (watched == window_ && shown_ && (event->type() == QEvent::Move || event->type() == QEvent::Resize))
    QTimer::singleShot(0, this, &FitOnScreen::fit);
  return QObject::eventFilter(watched, event);
}

void FitOnScreen::fit() {
  const QMargins frame = frame_();
  const bool normal = !(window_->windowState() & (Qt::WindowMaximized | Qt::WindowFullScreen | Qt::WindowMinimized));
  if (frame.isNull() || !normal) return;
  const QRect now = window_->geometry(), fitted = contentWithin(now, frame, window_->screen()->availableGeometry());
  if (fitted != now) window_->setGeometry(fitted);
}

}  // namespace glint::gui
