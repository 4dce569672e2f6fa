// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QObject>
#include <QString>
#include <optional>

#include "core/inspect/hand_edits.h"
#include "gui/base/actions.h"
#include "gui/base/job_queue.h"
#include "gui/document/document.h"

namespace glint::gui {

class FrameCanvas;

/// Ignores, merges, splits and grows observed highlights of the selected frame, at the place where the mouse is or was last in the
/// photograph. One edit is one step of undo; they are part of the what-if (core/inspect/hand_edits.h).
class HighlightEdits : public QObject {
  Q_OBJECT
 public:
  /// @param canvas  shows the selected frame
  HighlightEdits(Document& document, FrameCanvas* canvas, QObject* parent);
  void addActions(Actions& actions, QMenu* menu);
  bool busy() const { return queue_.busy(); }

  /// At the place, else at the selected highlight; what is ignored there is taken back.
  void ignore();
  /// The selected highlight with the one at the place; where these are one, with the nearest other one of the same light.
  void merge();
  void split();
  void grow();
  /// Takes all edits of the frame back.
  void asFound();

 signals:
  void problem(const QString& why);  ///< an edit cannot be made

 private:
  struct Target {
    std::shared_ptr<const Inspection> inspection;
    const FrameEvidence* evidence;  ///< of the selected frame
    int frame;
  };
  std::optional<Target> target();
  int under(const FrameEvidence& evidence) const;
  std::optional<Pixel> ideal() const;
  void push(const HighlightEdit& edit, const QString& what);

  Document& document_;
  std::optional<Pixel> place_;  ///< photograph pixel of the selected frame
  int placeFrame_ = -1;
  JobQueue queue_;
};

}  // namespace glint::gui
