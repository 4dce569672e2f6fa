// SPDX-License-Identifier: BSD-3-Clause
#include "gui/base/draw_turns.h"

#include <QCoreApplication>
#include <QPointer>
#include <QTimer>
#include <algorithm>
#include <deque>
#include <utility>

namespace glint::gui {

namespace {

class Turns : public QObject {
 public:
  explicit Turns(QObject* parent) : QObject(parent) {
    timer_.setInterval(0);  // fires when the event loop has nothing else to do
    connect(&timer_, &QTimer::timeout, this, &Turns::next);
  }

  void add(QObject* owner, std::function<void()> draw) {
    const auto known = std::find_if(waiting_.begin(), waiting_.end(), [&](const Turn& t) { return t.owner == owner; });
    if (known != waiting_.end())
      known->draw = std::move(draw);
    else
      waiting_.push_back({owner, std::move(draw)});
    if (!timer_.isActive()) timer_.start();
  }

  bool empty() const {
    return std::none_of(waiting_.begin(), waiting_.end(), [](const Turn& t) { return !t.owner.isNull(); });
  }

 private:
  struct Turn {
    QPointer<QObject> owner;
    std::function<void()> draw;
  };

  void next() {
    while (!waiting_.empty()) {
      const Turn turn = std::move(waiting_.front());
      waiting_.pop_front();
      if (waiting_.empty()) timer_.stop();  // before it draws: what asks meanwhile starts it again
      if (!turn.owner) continue;
      turn.draw();
      return;
    }
    timer_.stop();
  }

  std::deque<Turn> waiting_;
  QTimer timer_;
};

/// Lives as long as the application does; null before and after it.
Turns* turns() {
  static QPointer<Turns> all;
  if (!all && QCoreApplication::instance()) all = new Turns(QCoreApplication::instance());
  return all;
}

}  // namespace

void drawInTurn(QObject* owner, std::function<void()> draw) {
  if (Turns* all = turns()) all->add(owner, std::move(draw));
}

bool drawingsWait() { return turns() && !turns()->empty(); }

}  // namespace glint::gui
