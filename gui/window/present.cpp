// SPDX-License-Identifier: BSD-3-Clause
#include "gui/window/present.h"

#include <QAbstractSpinBox>
#include <QApplication>
#include <QKeyEvent>
#include <QLineEdit>
#include <QMainWindow>
#include <QMenuBar>
#include <QStatusBar>
#include <QToolBar>
#include <QWidget>
#include <utility>

namespace glint::gui {

namespace {
constexpr double kLarger = 1.5;  // texts that are read from the other end of a room

/// Where a style sheet has given a widget a font of its own (bold titles of docks), Qt does not take the application's to what is
/// inside of it; the sheet is read again for that.
void setTextFont(const QFont& font) {
  QApplication::setFont(font);
  qApp->setStyleSheet(qApp->styleSheet());
}
}  // namespace

Present::Present(QMainWindow* window, std::function<void()> arrange)
    : QObject(window), window_(window), arrange_(std::move(arrange)) {}

double Present::textScale() const { return on_ ? kLarger : 1; }

void Present::start() {
  if (std::exchange(on_, true)) return;
  docks_ = window_->saveState();  // of the tool bar, too: before it is hidden
  barsShown_.clear();
  QList<QWidget*> bars{window_->menuBar(), window_->statusBar()};
  for (QToolBar* bar : window_->findChildren<QToolBar*>(QString(), Qt::FindDirectChildrenOnly)) bars << bar;
  for (QWidget* bar : std::as_const(bars)) {
    barsShown_.insert(bar, !bar->isHidden());
    bar->hide();
  }
  state_ = window_->windowState();
  font_ = QApplication::font();
  QFont large = font_;
  large.setPointSizeF(kLarger * font_.pointSizeF());
  setTextFont(large);
  arrange_();
  window_->setWindowState(state_ | Qt::WindowFullScreen);
  qApp->installEventFilter(this);
  emit changed(true);
}

void Present::leave() {
  if (!std::exchange(on_, false)) return;
  qApp->removeEventFilter(this);
  setBlack(false);
  window_->setWindowState(state_);
  setTextFont(font_);
  for (auto it = barsShown_.cbegin(); it != barsShown_.cend(); ++it) it.key()->setVisible(it.value());
  window_->restoreState(docks_);
  emit changed(false);
}

void Present::setBlack(bool black) {
  if (black == (black_ != nullptr)) return;
  if (!black) {
    delete std::exchange(black_, nullptr);
    return;
  }
  black_ = new QWidget(window_);
  black_->setObjectName(QStringLiteral("present.black"));
  black_->setAutoFillBackground(true);
  QPalette palette;
  palette.setColor(QPalette::Window, Qt::black);
  black_->setPalette(palette);
  black_->setStyleSheet(QStringLiteral("background: black"));
  black_->setGeometry(window_->rect());
  black_->show();
  black_->raise();
}

/// @return whether the key is one of a presentation's.
bool Present::take(int key) {
  switch (key) {
    case Qt::Key_PageDown:
      setBlack(false);
      emit step(1);
      return true;
    case Qt::Key_PageUp:
      setBlack(false);
      emit step(-1);
      return true;
    case Qt::Key_B: setBlack(black_ == nullptr); return true;
    case Qt::Key_Escape: black_ ? setBlack(false) : leave(); return true;
    default: return false;
  }
}

bool Present::eventFilter(QObject* watched, QEvent* event) {
  // Shortcuts are asked first: a key that is taken there comes again as a press, and only then does something.
  if (event->type() != QEvent::KeyPress && event->type() != QEvent::ShortcutOverride) return false;
  const auto* widget = qobject_cast<QWidget*>(watched);
  if (!widget || widget->window() != window_ || QApplication::activeModalWidget()) return false;
  const auto* key = static_cast<QKeyEvent*>(event);
  if (key->modifiers() & ~Qt::KeypadModifier) return false;
  const int code = key->key();
  if (code == Qt::Key_B && (qobject_cast<const QLineEdit*>(widget) || qobject_cast<const QAbstractSpinBox*>(widget)))
    return false;
  const bool ours = code == Qt::Key_PageDown || code == Qt::Key_PageUp || code == Qt::Key_B || code == Qt::Key_Escape;
  if (!ours) return false;
  if (event->type() == QEvent::ShortcutOverride) {
    event->accept();
    return true;
  }
  return take(code);
}

}  // namespace glint::gui
