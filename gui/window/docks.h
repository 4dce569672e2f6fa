// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QMainWindow>
#include <QMap>
#include <QString>

#include "gui/base/actions.h"
#include "gui/window/layouts.h"

class QDockWidget;

namespace glint::gui {

/// The docks of the window by their names: which lie behind which, and what a layout shows of them.
class Docks {
 public:
  explicit Docks(QMainWindow* window) : window_(window) {}
  /// @param behind  name of the dock that it is a tab behind; "" = it has a place of its own.
  QDockWidget* add(const char* name, const QString& title, QWidget* content, Qt::DockWidgetArea area, const char* behind = "");
  /// Shows a dock and puts it before its tabs. std::invalid_argument for an unknown name.
  void bring(const QString& name);
  void apply(const Layout& layout);
  /// One toggle for each dock; one that lies behind another comes to the front instead of going away.
  void addActions(Actions& actions, QMenu* menu);

 private:
  QDockWidget* at(const QString& name) const;
  QMainWindow* window_;
  QMap<QString, QDockWidget*> docks_;
  QMap<QString, QString> hosts_;  ///< of those that are tabs behind another one
};

}  // namespace glint::gui
