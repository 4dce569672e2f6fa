// SPDX-License-Identifier: BSD-3-Clause
#include "gui/window/scripted_actions.h"

#include <QAction>
#include <utility>

#include "core/base/outcome.h"

namespace glint::gui {

namespace {
constexpr int kLookMs = 30;
}

ScriptedActions::ScriptedActions(Actions& actions, std::function<bool()> quiet, QObject* parent)
    : QObject(parent), actions_(actions), quiet_(std::move(quiet)) {
  connect(&clock_, &QTimer::timeout, this, [this] {
    if (!quiet_()) return;
    actions_.find(waiting_.takeFirst())->trigger();
    if (waiting_.isEmpty()) clock_.stop();
  });
}

void ScriptedActions::run(const QStringList& ids) {
  QStringList known;
  for (const QAction* action : actions_.all()) known << Actions::id(action);
  for (const QString& id : ids)
    if (!known.contains(id))
      throw InputError("", "--run",
                       "'" + id.toStdString() + "' is not one of: " + known.join(QStringLiteral(", ")).toStdString());
  waiting_ += ids;
  if (!waiting_.isEmpty()) clock_.start(kLookMs);
}

}  // namespace glint::gui
