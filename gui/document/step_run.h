// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QElapsedTimer>

#include "gui/document/document.h"

namespace glint::gui {

/// The steps of a key that is held down, or in quick succession, are one intention: one step of undo.
class StepRun {
 public:
  /// @return the gesture of this step: that of the step before where it came within 600 ms, else a new one.
  int gesture(Document& document) {
    constexpr qint64 kRunMs = 600;
    if (!since_.isValid() || since_.elapsed() > kRunMs) gesture_ = document.newGesture();
    since_.start();
    return gesture_;
  }

 private:
  QElapsedTimer since_;
  int gesture_ = 0;
};

}  // namespace glint::gui
