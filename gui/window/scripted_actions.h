// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QObject>
#include <QStringList>
#include <QTimer>
#include <functional>

#include "gui/base/actions.h"

namespace glint::gui {

/// Runs actions by their ids, one after the other, each once the window is quiet (--run).
class ScriptedActions : public QObject {
  Q_OBJECT
 public:
  ScriptedActions(Actions& actions, std::function<bool()> quiet, QObject* parent);
  /// InputError that lists the ids for an unknown one; nothing runs then.
  void run(const QStringList& ids);
  bool done() const { return waiting_.isEmpty(); }

 private:
  Actions& actions_;
  std::function<bool()> quiet_;
  QStringList waiting_;
  QTimer clock_;
};

}  // namespace glint::gui
