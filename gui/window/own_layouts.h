// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QList>
#include <QObject>

#include "gui/base/actions.h"

class QMainWindow;
class QSplitter;

namespace glint::gui {

/// The user's own arrangements of docks and views: a few numbered places, kept in the program's settings.
class OwnLayouts : public QObject {
  Q_OBJECT
 public:
  static constexpr int kPlaces = 3;
  /// @param views  the views that share the middle of the window
  OwnLayouts(QMainWindow* window, QSplitter* views);
  void addActions(Actions& actions, QMenu* menu);
  bool has(int place) const;  ///< 1 .. kPlaces
  void keep(int place);       ///< stores the present arrangement in the place
  void apply(int place);      ///< does nothing for an empty place

 signals:
  void applied();

 private:
  void refresh();
  QMainWindow* window_;
  QSplitter* views_;
  QList<QAction*> goTo_;
};

}  // namespace glint::gui
