// SPDX-License-Identifier: BSD-3-Clause
#include "gui/window/scripted_actions.h"

#include <QAction>
#include <string>
#include <utility>
#include <vector>

#include "core/base/outcome.h"
#include "core/base/words.h"

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
  std::vector<std::string> known;
  for (const QAction* action : actions_.all()) known.push_back(Actions::id(action).toStdString());
  for (const QString& id : ids)
    if (!actions_.find(id))
      throw InputError(
          "", "--run",
          "'" + id.toStdString() + "' is no action" + didYouMean(id.toStdString(), known) + "; `--run list` prints all");
  waiting_ += ids;
  if (!waiting_.isEmpty()) clock_.start(kLookMs);
}

}  // namespace glint::gui
