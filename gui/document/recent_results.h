// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "core/inspect/inspection.h"

namespace glint::gui {

/// The last finished results of the open scene, by the whole request that they answer: undo, redo and a setting that is flipped
/// back show them at once. Files that change on disk do not count until the scene is opened again, as in a run, which takes over
/// what an earlier run has read.
class RecentResults {
 public:
  /// Those on screen, those before and after a step to either side of them, and room for one detour. They share what the change
  /// between them leaves alone; in the worst case each holds all its contours and predictions.
  static constexpr std::size_t kMost = 5;

  using Leads = std::function<bool(const InspectionRequest&)>;
  /// @param leads  whether a step of undo or redo leads to a request: positions that a slider only passed go first.
  void keep(std::shared_ptr<const Inspection> results, const InspectionRequest& computedFor, const Leads& leads);
  /// Null if none are kept.
  std::shared_ptr<const Inspection> find(const InspectionRequest& request);
  void clear() { kept_.clear(); }

 private:
  using Kept = std::pair<InspectionRequest, std::shared_ptr<const Inspection>>;
  std::vector<Kept> kept_;  ///< those that were shown last at the end
};

}  // namespace glint::gui
