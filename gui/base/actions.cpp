// SPDX-License-Identifier: BSD-3-Clause
#include "gui/base/actions.h"

#include <QAction>
#include <QMenu>
#include <QSettings>
#include <QVariant>
#include <utility>

#include "core/base/outcome.h"
#include "gui/base/theme.h"

namespace glint::gui {

namespace {
const char* const kDefaults = "glintDefaultShortcuts";
const char* const kMenuPath = "glintMenuPath";

QString plain(QString title) {
  title.remove(QLatin1Char('&'));
  if (title.endsWith(QChar(0x2026))) title.chop(1);
  return title;
}

QString settingKey(const QAction* action) { return QStringLiteral("shortcuts/") + action->objectName(); }

QStringList toText(const QList<QKeySequence>& shortcuts) {
  QStringList text;
  for (const QKeySequence& s : shortcuts) text << s.toString(QKeySequence::PortableText);
  return text;
}

QList<QKeySequence> fromText(const QStringList& text) {
  QList<QKeySequence> shortcuts;
  for (const QString& s : text)
    if (!s.isEmpty()) shortcuts << QKeySequence::fromString(s, QKeySequence::PortableText);
  return shortcuts;
}

/// Titles of a menu and of those that it lies in.
QString pathOf(const QMenu* menu) {
  QString path;
  for (; menu; menu = qobject_cast<const QMenu*>(menu->parentWidget()))
    path = plain(menu->title()) + (path.isEmpty() ? QString() : QStringLiteral(" › ") + path);
  return path;
}
}  // namespace

QAction* Actions::take(const QString& id, QMenu* menu, QAction* action, const Look& look) {
  require(!find(id), "Actions: the id exists: " + id.toStdString());
  action->setObjectName(id);
  if (!look.icon.isEmpty()) {
    action->setIcon(icon(look.icon));
    action->setProperty("glintIcon", look.icon);
  }
  if (!look.tip.isEmpty()) action->setToolTip(look.tip);
  if (!look.tip.isEmpty()) action->setStatusTip(look.tip);
  action->setProperty(kDefaults, toText(look.shortcuts));
  action->setProperty(kMenuPath, pathOf(menu));
  action->setShortcuts(look.shortcuts);
  menu->addAction(action);
  actions_.append(action);
  return action;
}

QAction* Actions::add(const QString& id, QMenu* menu, const QString& title, std::function<void()> run, const Look& look) {
  auto* action = new QAction(title, menu);
  connect(action, &QAction::triggered, this, [run = std::move(run)] { run(); });
  return take(id, menu, action, look);
}

QAction* Actions::addToggle(const QString& id, QMenu* menu, const QString& title, std::function<void(bool)> run,
                            const Look& look) {
  auto* action = new QAction(title, menu);
  action->setCheckable(true);
  connect(action, &QAction::triggered, this, [run = std::move(run)](bool on) { run(on); });
  return take(id, menu, action, look);
}

QAction* Actions::adopt(const QString& id, QMenu* menu, QAction* action, const Look& look) {
  return take(id, menu, action, look);
}

QAction* Actions::find(const QString& id) const {
  for (QAction* action : actions_)
    if (action->objectName() == id) return action;
  return nullptr;
}

QString Actions::id(const QAction* action) { return action->objectName(); }
QString Actions::title(const QAction* action) { return plain(action->text()); }
QString Actions::path(const QAction* action) {
  return action->property(kMenuPath).toString() + QStringLiteral(" › ") + title(action);
}
QList<QKeySequence> Actions::defaultShortcuts(const QAction* action) {
  return fromText(action->property(kDefaults).toStringList());
}

void Actions::loadShortcuts() {
  const QSettings settings;
  for (QAction* action : std::as_const(actions_))
    if (settings.contains(settingKey(action))) action->setShortcuts(fromText(settings.value(settingKey(action)).toStringList()));
}

void Actions::setShortcuts(QAction* action, const QList<QKeySequence>& shortcuts) {
  action->setShortcuts(shortcuts);
  QSettings settings;
  if (shortcuts == defaultShortcuts(action))
    settings.remove(settingKey(action));
  else
    settings.setValue(settingKey(action), toText(shortcuts));
}

}  // namespace glint::gui
