// SPDX-License-Identifier: BSD-3-Clause
#include "gui/window/pinned_results.h"

#include <QAction>
#include <QDockWidget>
#include <QEvent>
#include <QLabel>
#include <QMainWindow>
#include <QMenu>
#include <QStatusBar>

namespace glint::gui {

namespace {
// Those that show results.
const char* const kDocks[] = {"errors", "plots", "timeline", "numbers", "conditioning", "ladder"};

/// In the middle of a view's lower edge, where no view has its legend; takes no clicks.
class PinnedBadge : public QLabel {
 public:
  explicit PinnedBadge(QWidget* view) : QLabel(QObject::tr("Pinned state"), view) {
    setObjectName(QStringLiteral("pinnedBadge"));
    setAttribute(Qt::WA_TransparentForMouseEvents);
    setStyleSheet(QStringLiteral("background: #8a1f6b; color: white; border-radius: 4px; padding: 2px 8px; font-weight: bold;"));
    view->installEventFilter(this);
    hide();
  }

 protected:
  bool eventFilter(QObject* watched, QEvent* event) override {
    if (event->type() == QEvent::Resize) place();
    return QLabel::eventFilter(watched, event);
  }
  void showEvent(QShowEvent* event) override {
    QLabel::showEvent(event);
    place();
    raise();
  }

 private:
  void place() {
    constexpr int kMargin = 6;  // px
    adjustSize();
    move((parentWidget()->width() - width()) / 2, parentWidget()->height() - height() - kMargin);
  }
};
}  // namespace

PinnedResults::PinnedResults(Document& document, const QList<QWidget*>& views, QMainWindow* window)
    : QObject(window), document_(document), window_(window), state_(new QLabel) {
  for (QWidget* view : views) {
    auto* const canvas = view->findChild<QWidget*>(QStringLiteral("frameCanvas"));  // below it are numbers
    badges_ << new PinnedBadge(canvas ? canvas : view);
  }
  for (const char* name : kDocks)  // a badge would cover their numbers: their titles say it
    if (auto* dock = window_->findChild<QDockWidget*>(QLatin1String(name))) titles_[dock] = dock->windowTitle();
  state_->setObjectName(QStringLiteral("pinnedState"));
  window_->statusBar()->addPermanentWidget(state_);
  connect(&document_, &Document::pinnedChanged, this, &PinnedResults::refresh);
  connect(&document_, &Document::inspectionChanged, this, &PinnedResults::refresh);
}

void PinnedResults::addActions(Actions& actions, QMenu* menu) {
  actions_ = &actions;
  menu->addSeparator();
  pin_ = actions.add(
      "view.pin", menu, tr("P&in current results"), [this] { pin(); },
      {{},
       {},
       tr("Keeps these results to compare with: change something, and the error table shows what became of each error. "
          "Not stored, no step of undo")});
  flip_ = actions.addToggle("view.pinned", menu, tr("Show pinned &state"), [this](bool on) { document_.showPinned(on); },
                            {{QKeySequence("Shift+P")}, {}, tr("Flips every view between the pinned and the newest results")});
  unpin_ = actions.add("view.unpin", menu, tr("&Unpin results"), [this] { document_.unpin(); });
  refresh();
}

void PinnedResults::pin() {
  if (!document_.pin()) return emit message(tr("There are no results to pin yet"));
  emit message(document_.stale()
                   ? tr("Pinned the last results; they are out of date")
                   : tr("Results pinned: %1 flips to them and back").arg(flip_->shortcut().toString(QKeySequence::NativeText)));
}

void PinnedResults::refresh() {
  const bool pinned = document_.pinned() != nullptr, shown = document_.pinnedShown();
  const QString key = flip_ ? flip_->shortcut().toString(QKeySequence::NativeText) : QString();
  state_->setVisible(pinned);
  state_->setText(shown ? tr("Pinned state shown (%1: newest)").arg(key) : tr("Results pinned (%1: show them)").arg(key));
  state_->setToolTip(
      shown ? tr("Views show the pinned results. A change of settings shows the newest ones again; exports are off until then")
            : tr("The error table compares with the pinned results"));
  for (QLabel* badge : std::as_const(badges_)) badge->setVisible(shown);
  for (auto it = titles_.cbegin(); it != titles_.cend(); ++it)
    it.key()->setWindowTitle(shown ? tr("%1 – pinned state").arg(it.value()) : it.value());
  if (!flip_) return;
  flip_->setChecked(shown);
  flip_->setEnabled(pinned);
  unpin_->setEnabled(pinned);
  pin_->setEnabled(document_.computed() != nullptr);
  if (!shown) {
    for (QAction* action : std::as_const(held_)) action->setEnabled(true);
    held_.clear();
  } else if (held_.isEmpty()) {
    for (QAction* action : actions_->all())
      if (Actions::id(action).startsWith(QLatin1String("export.")) && action->isEnabled()) {
        action->setEnabled(false);
        held_ << action;
      }
  }
}

}  // namespace glint::gui
