// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <memory>

#include "core/pipeline/pipeline.h"

namespace glint::gui {

/// What there is to show of the open scene, and which of it is newer: complete answers, what came ahead of one for the selected
/// frame, and what was observed in that frame since then. Its pipeline remembers the last answers, so that undo, redo and a
/// setting that is flipped back show them at once.
class Results {
 public:
  using Answer = Pipeline::Answer;
  Results() = default;
  explicit Results(std::shared_ptr<const Scene> scene);

  /// Whom to ask for more; null without a scene.
  const std::shared_ptr<Pipeline>& pipeline() const { return pipeline_; }
  /// The newest complete answer; null before the first.
  const Answer& complete() const { return complete_; }
  /// The newest for the selected frame: complete(), or what came before it was.
  const Answer& newest() const { return ahead_ ? ahead_ : complete_; }
  /// newest(), beside what was observed in the frame since then.
  const Answer& ofFrame() const { return observed_ ? observed_ : newest(); }
  bool isAhead(const InspectionRequest& request) const { return ahead_ && ahead_->request == request; }

  /// A complete answer is kept; makeRoom() says how many are.
  /// @param show   else it is only kept
  /// @param asked  what is asked for now
  /// @param wanted see Pipeline::makeRoom()
  void take(Answer answer, const InspectionRequest& computedFor, bool show, const InspectionRequest& asked,
            const std::function<bool(const InspectionRequest&)>& wanted);
  void takeAhead(Answer answer, const InspectionRequest& asked);
  /// Null = nothing else is observed than newest() says. Returns whether ofFrame() changed.
  bool observe(std::shared_ptr<const Observation> observation, const InspectionRequest& asked);
  /// Another frame is selected: what was ahead for the old one is gone.
  void leaveFrame();
  /// Shows the complete answer to this request, if it is remembered; else false.
  bool show(const InspectionRequest& request);

 private:
  void putBeside(const InspectionRequest& asked);

  std::shared_ptr<Pipeline> pipeline_;
  Answer complete_, ahead_, observed_;
  std::shared_ptr<const Observation> observation_;  ///< newer than newest(); null = none
};

}  // namespace glint::gui
