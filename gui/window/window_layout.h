// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QByteArray>
#include <QObject>
#include <QSize>
#include <QString>
#include <optional>

#include "gui/window/docks.h"

class QSplitter;

namespace glint::gui {

/// How the docks and the views in the middle of the window are arranged: as one of the layouts says, as the user keeps them, or
/// for a while, as a task needs that the user has started.
class WindowLayout : public QObject {
  Q_OBJECT
 public:
  /// @param views  the views that share the middle of the window.
  WindowLayout(QMainWindow* window, Docks& docks, QSplitter* views);
  /// Name of the layout that was applied last.
  const QString& name() const { return name_; }
  void apply(const QString& name);
  /// No docks while nothing is open. @see showAgain
  void hideUntilOpen();
  /// The docks of the layout that was applied last, where they were hidden.
  void showAgain();
  /// The user's own arrangement was applied: it stays as it is, whatever size the window gets.
  void setOwn();
  /// Arranges the window as the layout `dock` does, if that dock is not shown as it should be, and brings it to the front.
  /// @param rearrange  else the dock is only brought to the front.
  /// @return whether the views have another size now.
  bool makeRoomFor(const QString& dock, bool rearrange);
  /// As it was before makeRoomFor(), unless another layout was chosen meanwhile.
  void putBack();
  /// The window has got another size.
  void followSize();
  /// The least size that the window may get. @param needs  of what it shows now.
  QSize leastSize(QSize needs) const;

 private:
  struct Arrangement {
    QString name;
    bool own = false;
    QSize size;
    QByteArray docks, views;
  };
  QMainWindow* window_;
  Docks& docks_;
  QSplitter* views_;
  QString name_;
  bool own_ = false;
  bool hidden_ = false;                ///< see hideUntilOpen()
  std::optional<Arrangement> before_;  ///< to go back to; none if makeRoomFor() found what it wants
};

}  // namespace glint::gui
