// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QObject>
#include <QString>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "core/pipeline/hand_edits.h"
#include "gui/base/actions.h"
#include "gui/base/job_queue.h"
#include "gui/document/document.h"

class QAction;
class QMenu;

namespace glint::gui {

class FrameCanvas;

/// Ignores, merges, splits and grows observed highlights of the selected frame, at the place where the mouse is or was last in
/// the photograph. One edit is one step of undo; they are part of the what-if (core/pipeline/hand_edits.h).
class HighlightEdits : public QObject {
  Q_OBJECT
 public:
  /// @param canvas  shows the selected frame
  HighlightEdits(Document& document, FrameCanvas* canvas, QObject* parent);
  void addActions(Actions& actions, QMenu* menu);
  bool busy() const { return queue_.busy(); }
  /// While this menu is open, those of the edits that cannot be made now are disabled, and their tool tips say why.
  void offerIn(QMenu* menu);

 signals:
  void problem(const QString& why);  ///< an edit cannot be made

 private:
  struct Target {
    std::shared_ptr<const Inspection> inspection;
    const FrameEvidence* evidence;  ///< of the selected frame; null if it is not known
    int frame;
  };
  /// An edit at the place under the pointer, or why it cannot be made.
  struct Plan {
    QString whyNot;             ///< "" = it can
    std::function<void()> run;  ///< makes it
  };
  Plan ignore();  ///< at the place, else the selected highlight; what is ignored there is taken back
  /// The selected highlight with the one at the place; if these are one, with the nearest other one of its light.
  Plan merge();
  Plan split();
  Plan grow();
  Plan undoAll();  ///< takes all edits of the frame back
  void carryOut(const Plan& plan);
  Target target() const;
  QString notKnown() const;
  int under(const FrameEvidence& evidence) const;
  std::optional<Pixel> ideal() const;
  void push(const HighlightEdit& edit, const QString& what);
  Plan pushing(const HighlightEdit& edit, const QString& what);
  void countAgain(const Highlight& highlight, int frame);
  void growAt(const Target& target, const Pixel& at);

  struct Offered {
    QAction* action;
    Plan (HighlightEdits::*plan)();
    QString tip;
  };
  std::vector<Offered> offered_;
  Document& document_;
  std::optional<Pixel> place_;  ///< photograph pixel of the selected frame
  int placeFrame_ = -1;
  JobQueue queue_;
};

}  // namespace glint::gui
