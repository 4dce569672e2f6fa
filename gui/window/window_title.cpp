// SPDX-License-Identifier: BSD-3-Clause
#include "gui/window/window_title.h"

#include <QFileInfo>

#include "gui/base/text.h"

namespace glint::gui {

QString titleOf(const Document& document) {
  const QFileInfo session(document.sessionFile()), input(document.inputFile());
  const bool isSession = !document.sessionFile().isEmpty();
  const QString scene = document.scene() ? nameText(document.scene()->name) : QString();
  if (scene.isEmpty()) return shownText((isSession ? session : input).fileName());
  if (!isSession || shownText(session.completeBaseName()) == scene) return scene;
  return QStringLiteral("%1 (%2)").arg(scene, shownText(session.fileName()));
}

}  // namespace glint::gui
