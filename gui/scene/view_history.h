// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "viz/scene_view.h"

class QUndoStack;
class QUndoCommand;

namespace glint::gui {

/// The places of the 3D views in every arrangement of the undo history. Moving a view is no step of undo, but a step that
/// arranges the views otherwise moves them: linked views follow one, new views start at one. Going back over such a step brings
/// each view back to its place.
class ViewHistory {
 public:
  using Places = std::vector<viz::ViewPoint>;  ///< of all views, shown or not
  explicit ViewHistory(const QUndoStack* stack) : stack_(stack) { forget(); }
  /// Another scene: its history starts here.
  void forget();
  /// A step arranges the views otherwise; call before they move. @param places  nothing if they have no place yet.
  void leave(const std::optional<Places>& places);
  /// The stack's index has changed. Where the views go back to; nothing after a new step, or one that arranged nothing.
  std::optional<Places> arrive();

 private:
  /// An arrangement, from the state that a step made (the first: none) to the next one that arranges otherwise.
  struct Stay {
    int from;                  ///< index of its first state in the stack
    const QUndoCommand* step;  ///< that made it
    std::optional<Places> places;
  };
  std::size_t stayAt(int index) const;

  const QUndoStack* stack_;
  std::vector<Stay> stays_;  ///< by `from`
  int index_ = 0;            ///< of the stack when it changed last
  bool left_ = false;
};

}  // namespace glint::gui
