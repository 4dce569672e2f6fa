// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QObject>

namespace glint::gui {

/// Gives the keys of undo and redo to the window if the field with the keyboard's focus has nothing to undo itself:
/// Qt's fields always swallow them, so that an entered value could not be undone. Text that is being typed and not
/// entered yet remains the field's. Lives as long as its parent; of the whole application.
class UndoKeys : public QObject {
  Q_OBJECT
 public:
  explicit UndoKeys(QObject* parent);

 protected:
  bool eventFilter(QObject* watched, QEvent* e) override;
};

}  // namespace glint::gui
