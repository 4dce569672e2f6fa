// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QObject>
#include <QStringList>

class QMenu;
class QTableView;

namespace glint::gui {

/// Which columns of the error table are shown: chosen in a menu, which a right click on a heading opens, and kept in the
/// program's settings. Those of pinned results come and go with them.
class ErrorColumns : public QObject {
  Q_OBJECT
 public:
  explicit ErrorColumns(QTableView* view);
  QMenu* menu() const { return menu_; }
  bool shown(int column) const;
  void setShown(int column, bool shown);
  void setPinned(bool pinned);

 private:
  void fill();
  void apply();
  void keep() const;

  QTableView* view_;
  QMenu* menu_;
  QStringList hidden_;  ///< ids
  bool pinned_ = false;
};

}  // namespace glint::gui
