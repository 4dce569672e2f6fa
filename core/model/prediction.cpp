// SPDX-License-Identifier: BSD-3-Clause
#include "core/model/model.h"

namespace glint {

Prediction::Prediction(std::vector<PredictedHighlight> found, std::optional<Failure> why) : answer_(std::move(found)) {
  if (highlights().empty()) answer_ = why ? std::move(*why) : Failure{Reason::NoBrightestPoint, ""};
}

const std::vector<PredictedHighlight>& Prediction::highlights() const {
  static const std::vector<PredictedHighlight> none;
  const auto* const found = std::get_if<std::vector<PredictedHighlight>>(&answer_);
  return found ? *found : none;
}

std::span<PredictedHighlight> Prediction::editable() {
  auto* const found = std::get_if<std::vector<PredictedHighlight>>(&answer_);
  return found ? std::span(*found) : std::span<PredictedHighlight>();
}

void Prediction::drop(const std::function<std::optional<Failure>(const PredictedHighlight&)>& reasonFor) {
  auto* const found = std::get_if<std::vector<PredictedHighlight>>(&answer_);
  if (!found) return;
  std::optional<Failure> first;
  std::erase_if(*found, [&](const PredictedHighlight& h) {
    std::optional<Failure> reason = reasonFor(h);
    if (reason && !first) first = reason;
    return reason.has_value();
  });
  if (found->empty() && first) answer_ = std::move(*first);
}

}  // namespace glint
