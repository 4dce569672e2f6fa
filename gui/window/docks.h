// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QList>
#include <QMainWindow>
#include <QMap>
#include <QSize>
#include <QString>
#include <functional>
#include <optional>

#include "gui/base/actions.h"
#include "gui/window/layouts.h"

class QDockWidget;

namespace glint::gui {

/// The docks of the window by their names: which lie behind which, and what a layout shows of them.
class Docks {
 public:
  explicit Docks(QMainWindow* window) : window_(window) {}
  /// Large content gets scroll bars. It has no place in the window before the first apply().
  /// @param behind  name of the dock that it is a tab behind; "" = it has a place of its own, where the window is large.
  QDockWidget* add(const char* name, const QString& title, QWidget* content, Qt::DockWidgetArea area, const char* behind = "");
  /// Shows a dock and puts it before its tabs; where it would cover the dock that is to stay visible, beside the views instead.
  /// std::invalid_argument for an unknown name.
  void bring(const QString& name);
  /// The views get the height that this dock does not need.
  void keepLow(const QString& name);
  /// @param needed  whether this dock must stay visible now, when another one is brought.
  void keepVisible(const QString& name, std::function<bool()> needed);
  /// Until a layout is applied.
  void hideAll();
  /// Shows what the layout names. In a window that is narrow or low, docks become tabs of one another, so that the views keep
  /// room; what was moved by hand stays there while the window does not change between these.
  void apply(const Layout& layout);
  /// The docks are arranged for a window of this size.
  bool fits() const { return room_ && *room_ == room(); }
  /// The least size that the window may get. @param needs  of its docks as they are arranged now: in a smaller window they will
  /// be tabs and need less.
  QSize least(QSize needs) const;
  /// A widget of a dock that lies behind another tab: Qt counts it as visible.
  static bool isBehind(const QWidget* widget);
  /// One toggle for each dock; one that lies behind another comes to the front instead of going away.
  void addActions(Actions& actions, QMenu* menu);

 private:
  struct Place {
    QString name;
    Qt::DockWidgetArea area;
    QString behind;
  };
  struct Room {
    bool narrow = false, low = false;
    bool operator==(const Room& other) const { return narrow == other.narrow && low == other.low; }
  };
  QDockWidget* at(const QString& name) const;
  Room room() const;
  QString host(const Place& place, const Room& room) const;
  void arrange(const Room& room);
  bool wouldCover(QDockWidget* dock) const;
  QMainWindow* window_;
  QMap<QString, QDockWidget*> docks_;
  QList<Place> places_;       ///< in the order of adding
  std::optional<Room> room_;  ///< that the docks are arranged for
  QString kept_;              ///< see keepVisible()
  std::function<bool()> needed_;
  bool moved_ = false;  ///< a dock was put beside the views: the next layout puts it back
};

}  // namespace glint::gui
