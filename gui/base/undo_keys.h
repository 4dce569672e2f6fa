// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QObject>

namespace glint::gui {

/// Gives the keys of undo and redo to the window where the field with the keyboard's focus has nothing of its own to take back:
/// Qt's fields swallow them always, so that a value that has just been typed could not be undone. What is being typed and not
/// entered yet is still the field's. Lives as long as its parent; of the whole application.
class UndoKeys : public QObject {
  Q_OBJECT
 public:
  explicit UndoKeys(QObject* parent);

 protected:
  bool eventFilter(QObject* watched, QEvent* e) override;
};

}  // namespace glint::gui
