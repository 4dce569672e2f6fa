// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QUndoCommand>

#include "gui/document/document.h"

namespace glint::gui {

/// One step of undo: the state before and after. The state is small (numbers and names), so steps keep whole copies
/// and undo cannot drift. Steps with the same non-empty merge key become one.
class StateCommand : public QUndoCommand {
 public:
  StateCommand(Document& document, ViewState before, ViewState after, const QString& text, QString mergeKey);
  void undo() override;
  void redo() override;
  /// The step leads to this request, or back to it.
  bool leadsTo(const InspectionRequest& request) const { return before_.request == request || after_.request == request; }
  int id() const override { return mergeKey_.isEmpty() ? -1 : 1; }
  bool mergeWith(const QUndoCommand* later) override;

 private:
  Document& document_;
  ViewState before_, after_;
  QString mergeKey_;
};

}  // namespace glint::gui
