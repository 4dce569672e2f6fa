// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QKeySequence>
#include <QList>
#include <QObject>
#include <QString>
#include <functional>

class QAction;
class QMenu;

namespace glint::gui {

/// Every action of the program, each under an id that stays the same between versions ("view.frame-all"): menus show them, the
/// command palette finds them, the user's shortcuts are kept by their ids. Panels add theirs in `addActions(Actions&, QMenu*)`.
class Actions : public QObject {
  Q_OBJECT
 public:
  explicit Actions(QObject* parent = nullptr) : QObject(parent) {}

  struct Look {
    QList<QKeySequence> shortcuts = {};  ///< by default; the user may change them
    QString icon = {};                   ///< of resources/icons, "" = none
    QString tip = {};                    ///< one sentence where the title does not say it all
  };
  /// A new action at the end of a menu. std::invalid_argument for an id that exists.
  QAction* add(const QString& id, QMenu* menu, const QString& title, std::function<void()> run, const Look& look);
  QAction* add(const QString& id, QMenu* menu, const QString& title, std::function<void()> run) {
    return add(id, menu, title, std::move(run), Look());
  }
  /// The same for one that can be on or off; `run` gets the new state. The caller keeps its check mark current.
  QAction* addToggle(const QString& id, QMenu* menu, const QString& title, std::function<void(bool)> run, const Look& look);
  /// Takes an action that exists already (undo, the toggle of a dock) into the list, at the end of a menu.
  QAction* adopt(const QString& id, QMenu* menu, QAction* action, const Look& look);

  QAction* find(const QString& id) const;  ///< null for an unknown id
  QList<QAction*> all() const { return actions_; }
  static QString id(const QAction* action);
  /// "View › Layout › Debug": where the menus have it.
  static QString path(const QAction* action);
  static QString title(const QAction* action);  ///< without the mark of the key and the ellipsis
  static QList<QKeySequence> defaultShortcuts(const QAction* action);

  /// Shortcuts that the user changed, from and to the program's settings.
  void loadShortcuts();
  void setShortcuts(QAction* action, const QList<QKeySequence>& shortcuts);

 private:
  QAction* take(const QString& id, QMenu* menu, QAction* action, const Look& look);
  QList<QAction*> actions_;
};

}  // namespace glint::gui
