// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QObject>
#include <optional>

#include "core/pipeline/what_if.h"
#include "gui/document/document.h"
#include "gui/frame/frame_canvas.h"

namespace glint::gui {

/// Moves what the selected frame shows by hand, as a what-if: an observed contour (Shift: its size), its peak, or with Ctrl the
/// camera. One drag is one step of undo. Off until it is switched on: otherwise a drag moves the picture.
class HandTool : public QObject, public DragTool {
  Q_OBJECT
 public:
  explicit HandTool(Document& document, QObject* parent = nullptr);
  bool isOn() const { return on_; }
  void setOn(bool on);

  bool wouldTake(const Pixel& at, double nearPx, Qt::KeyboardModifiers modifiers) const override;
  bool take(const Pixel& at, double nearPx, Qt::KeyboardModifiers modifiers) override;
  void carry(const Pixel& to) override;
  void release() override { drag_.reset(); }
  bool holds() const { return drag_.has_value(); }

 signals:
  void onChanged(bool on);
  /// Where what is held is now, photograph pixels; results follow later.
  void carried(const std::vector<glint::Pixel>& line, const std::optional<glint::Pixel>& mark);

 private:
  struct Drag {
    Held held;
    int frame, highlight, gesture;
    Pixel from;  ///< ideal
    WhatIf start;
    Camera camera;
    Highlight now;
  };
  Document& document_;
  bool on_ = false;
  std::optional<Drag> drag_;
};

}  // namespace glint::gui
