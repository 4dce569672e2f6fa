// SPDX-License-Identifier: BSD-3-Clause
#include "gui/base/undo_keys.h"

#include <QCoreApplication>
#include <QDoubleSpinBox>
#include <QKeyEvent>
#include <QLineEdit>
#include <QSpinBox>

#include "gui/base/number_box.h"

namespace glint::gui {

namespace {
/// Typing that is not entered yet.
bool isPending(const QAbstractSpinBox& box) {
  if (const auto* number = qobject_cast<const NumberBox*>(&box); number && !number->problemOf(number->text()).isEmpty())
    return true;
  if (const auto* number = qobject_cast<const QDoubleSpinBox*>(&box))
    return number->valueFromText(number->text()) != number->value();
  const auto* whole = qobject_cast<const QSpinBox*>(&box);
  return whole && whole->cleanText() != QString::number(whole->value());
}

bool takes(const QObject* field, bool redo) {
  if (const auto* box = qobject_cast<const QAbstractSpinBox*>(field)) return isPending(*box);
  if (const auto* line = qobject_cast<const QLineEdit*>(field)) {
    if (const auto* box = qobject_cast<const QAbstractSpinBox*>(line->parent())) return isPending(*box);
    return redo ? line->isRedoAvailable() : line->isUndoAvailable();
  }
  return true;
}
}  // namespace

UndoKeys::UndoKeys(QObject* parent) : QObject(parent) { QCoreApplication::instance()->installEventFilter(this); }

bool UndoKeys::eventFilter(QObject* watched, QEvent* e) {
  if (e->type() != QEvent::ShortcutOverride) return false;
  auto* key = static_cast<QKeyEvent*>(e);
  const bool redo = key->matches(QKeySequence::Redo);
  if ((!redo && !key->matches(QKeySequence::Undo)) || takes(watched, redo)) return false;
  key->ignore();
  return true;
}

}  // namespace glint::gui
