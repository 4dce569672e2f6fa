// SPDX-License-Identifier: BSD-3-Clause
#include "gui/document/results.h"

#include <utility>

namespace glint::gui {

Results::Results(std::shared_ptr<const Scene> scene)
    : pipeline_(scene ? std::make_shared<Pipeline>(std::move(scene)) : nullptr) {}

void Results::take(Answer answer, const InspectionRequest& computedFor, bool show, const InspectionRequest& asked,
                   const std::function<bool(const InspectionRequest&)>& wanted) {
  if (!pipeline_) return;
  pipeline_->remember({computedFor}, answer);
  pipeline_->makeRoom(wanted);
  if (!show) return;
  complete_ = std::move(answer);
  ahead_.reset();
  putBeside(asked);
}

void Results::takeAhead(Answer answer, const InspectionRequest& asked) {
  ahead_ = std::move(answer);
  putBeside(asked);
}

bool Results::observe(std::shared_ptr<const Observation> observation, const InspectionRequest& asked) {
  const bool shown = observed_ != nullptr;
  observation_ = std::move(observation);
  putBeside(asked);
  return shown || observed_;
}

void Results::leaveFrame() {
  ahead_.reset();
  observed_.reset();
  observation_.reset();
}

bool Results::show(const InspectionRequest& request) {
  Answer known = pipeline_ ? pipeline_->known(request) : nullptr;
  if (!known) return false;
  complete_ = std::move(known);
  leaveFrame();
  return true;
}

void Results::putBeside(const InspectionRequest& asked) {
  observed_.reset();
  if (!observation_ || !newest()) return;
  // Results of an earlier position of the slider come after the observation of a later one: they must not put the contour back.
  if (newest()->request == asked || newest()->inputs.same(Stage::Evidence, observation_->inputs))
    observation_.reset();
  else
    observed_ = std::make_shared<const Inspection>(besideObservation(*newest(), *observation_));
}

}  // namespace glint::gui
