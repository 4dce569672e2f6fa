// SPDX-License-Identifier: BSD-3-Clause
#include "gui/document/state_command.h"

#include <utility>

#include "gui/base/text.h"

namespace glint::gui {

namespace {
/// The text in the history, and in a menu after "Undo".
QString twoTexts(const QString& text) { return text + QLatin1Char('\n') + menuText(text); }
}  // namespace

StateCommand::StateCommand(Document& document, ViewState before, ViewState after, const QString& text, QString mergeKey)
    : QUndoCommand(twoTexts(text)),
      document_(document),
      before_(std::move(before)),
      after_(std::move(after)),
      mergeKey_(std::move(mergeKey)) {}

void StateCommand::undo() { document_.apply(before_); }
void StateCommand::redo() { document_.apply(after_); }

bool StateCommand::mergeWith(const QUndoCommand* later) {
  const auto* next = static_cast<const StateCommand*>(later);  // Qt calls this for equal id() only
  if (next->mergeKey_ != mergeKey_) return false;
  after_ = next->after_;
  setText(twoTexts(next->text()));
  return true;
}

}  // namespace glint::gui
